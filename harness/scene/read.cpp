#include "harness/scene/read.h"

#include "harness/scene/load.h"

namespace raystudy {

Scene read_scene(const std::filesystem::path& file) { return load_scene({file}); }

}  // namespace raystudy
