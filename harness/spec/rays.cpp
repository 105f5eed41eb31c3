#include "harness/spec/rays.h"

#include <array>
#include <string_view>

namespace raystudy {

std::uint64_t estimated_rays(const MethodRef& workload) {
  constexpr std::array<std::string_view, 5> factors{"count", "width", "height", "samples", "rays"};
  if (!workload.params) return 0;
  std::uint64_t product = 1;
  bool any = false;
  for (const std::string_view name : factors) {
    const auto value = workload.params->values().find(name);
    if (value == workload.params->values().end()) continue;
    const auto* number = std::get_if<std::int64_t>(&value->second);
    if (number == nullptr) continue;
    any = true;
    product *= static_cast<std::uint64_t>(*number);
  }
  return any ? product : 0;
}

}  // namespace raystudy
