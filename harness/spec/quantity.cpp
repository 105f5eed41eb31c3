#include "harness/spec/quantity.h"

#include "harness/method/registry.h"

namespace raystudy {

const std::vector<Quantity>& harness_quantities() {
  static const std::vector<Quantity> all{
      {"triangles", "1", "triangles of the scene"},
      {"build_time", "s", "time of the builder"},
      {"optimize_time", "s", "time of all optimizers together"},
      {"encode_time", "s", "time of the encoder"},
      {"total_time", "s", "time of all stages: builder, optimizers, encoder"},
      {"peak_memory", "bytes", "most memory in use while building, over what the scene itself takes"},
      {"cost_over_time", "1", "cost of the tree while it is optimized, from the end of the builder", false, "seconds"},
      {"trace_time", "s", "time to trace the whole workload", true},
      {"trace_rate", "rays/s", "rays traced in a second", true},
      {"steps_per_ray", "1", "traversal steps a ray, inner nodes and leaves", true},
      {"inner_nodes_per_ray", "1", "inner nodes visited a ray", true},
      {"leaves_per_ray", "1", "leaves visited a ray", true},
      {"box_tests_per_ray", "1", "boxes tested a ray", true},
      {"triangle_tests_per_ray", "1", "triangles tested a ray", true},
      {"hit_share", "1", "share of the rays that hit something", true},
      {"ray_count", "1", "rays of the workload", true},
  };
  return all;
}

std::vector<Quantity> known_quantities() {
  std::vector<Quantity> all = harness_quantities();
  for (const Registry::Entry* entry : Registry::instance().entries()) {
    if (entry->role != Role::metric) continue;
    for (const MetricValueInfo& value : entry->info.values) {
      all.push_back({value.name, value.unit, value.summary.empty() ? entry->info.summary : value.summary, false, value.axis});
    }
  }
  return all;
}

}  // namespace raystudy
