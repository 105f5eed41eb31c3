#include "harness/scene/read.h"

#include "harness/scene/source.h"

namespace raystudy {

Scene read_scene(const std::filesystem::path& file) {
  const SourceFile source = open_source(file);
  Scene scene = reader_for(source)(source);
  scene.name = source.stem;
  finish_scene(scene, source.name);
  return scene;
}

}  // namespace raystudy
