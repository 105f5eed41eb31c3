#pragma once

#include <cstdint>

#include "harness/method/params.h"

namespace raystudy {

/// The most rays a workload can make, told from its parameters without opening a scene: `count`, or `width` · `height` ·
/// `samples` · `rays` of those it has. 0 for a workload that has none of them.
[[nodiscard]] std::uint64_t estimated_rays(const MethodRef& workload);

}  // namespace raystudy
