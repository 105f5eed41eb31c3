#include "harness/spec/quantity.h"

#include <algorithm>

#include "harness/method/registry.h"

namespace raystudy {
namespace {

struct Unit {
  std::string_view name;
  double factor = 0;  ///< in the family's base unit
};

/// Units of one dimension.
struct UnitFamily {
  std::vector<Unit> units;
  [[nodiscard]] double factor_of(std::string_view name) const {
    for (const Unit& unit : units) {
      if (unit.name == name) return unit.factor;
    }
    return 0;
  }
};

const std::vector<UnitFamily> unit_families{
    {{{"s", 1}, {"ms", 1e-3}, {"us", 1e-6}, {"min", 60}, {"h", 3600}}},
    {{{"bytes", 1}, {"KiB", 1024}, {"MiB", 1048576}, {"GiB", 1073741824}}},
    {{{"frames/s", 1}}},
    {{{"rays/s", 1}, {"krays/s", 1e3}, {"Mrays/s", 1e6}, {"Grays/s", 1e9}}},
    {{{"", 1}, {"1", 1}, {"%", 0.01}, {"k", 1e3}, {"M", 1e6}}},
};

Quantity of_animations(Quantity quantity) {
  quantity.animated = true;
  return quantity;
}

}  // namespace

const std::vector<Quantity>& harness_quantities() {
  static const std::vector<Quantity> all{
      {"triangles", "1", "triangles of the scene"},
      {"build_time", "s", "time of the builder"},
      {"optimize_time", "s", "time of all optimizers together"},
      {"encode_time", "s", "time of the encoder"},
      {"total_time", "s", "time of all stages: builder, optimizers, encoder"},
      {"peak_memory", "bytes", "most memory in use while building, over what the scene itself takes"},
      {"upload_time", "s", "time to bring to the device what is built there"},
      {"download_time", "s", "time to bring back what was built on a device"},
      {"device_memory", "bytes", "most memory of the device in use while building there"},
      {"level_time", "s", "time to build a level of the tree, of builders that go breadth first", false, "level"},
      {"level_active", "1", "nodes of a level that were to be split, of builders that go breadth first", false, "level"},
      {"cost_over_time", "1", "cost of the tree while it is optimized, from the end of the builder", false, "seconds"},
      {"cpu_time", "s", "processor time of all stages, over all threads"},
      of_animations({"average_cost", "1", "cost of the tree, mean over the frames"}),
      of_animations({"maximum_cost", "1", "cost of the tree in the frame where it is greatest"}),
      of_animations({"frame_cost", "1", "cost of the tree by frame", false, "frame"}),
      of_animations({"update_time", "s", "time to make the tree ready for a frame, its encoder included, mean over the frames"}),
      of_animations({"maximum_update_time", "s", "time to make the tree ready for the frame that takes longest"}),
      of_animations({"frame_update_time", "s", "time to make the tree ready, by frame", false, "frame"}),
      of_animations({"rebuilds", "1", "frames for which a tree was built while the animation played"}),
      of_animations({"frame_rebuilds", "1", "frames up to this one for which a tree was built", false, "frame"}),
      of_animations({"tree_memory", "bytes", "memory of all trees that are held while the animation plays"}),
      of_animations({"frame_time", "s", "time to update the tree and trace the rays, mean over the frames", true}),
      of_animations({"maximum_frame_time", "s", "time to update and trace of the frame that takes longest", true}),
      of_animations({"frame_rate", "frames/s", "frames updated and traced in a second", true, {}, true}),
      of_animations({"frame_total_time", "s", "time to update the tree and trace the rays, by frame", true, "frame"}),
      of_animations({"frame_trace_time", "s", "time to trace the rays, by frame", true, "frame"}),
      of_animations({"frame_trace_rate", "rays/s", "rays traced in a second, by frame", true, "frame", true}),
      {"trace_time", "s", "time to trace the whole workload, of an animation in all frames together", true},
      {"trace_rate", "rays/s", "rays traced in a second", true, {}, true},
      {"steps_per_ray", "1", "traversal steps a ray, inner nodes and leaves", true},
      {"inner_nodes_per_ray", "1", "inner nodes visited a ray", true},
      {"leaves_per_ray", "1", "leaves visited a ray", true},
      {"box_tests_per_ray", "1", "boxes tested a ray", true},
      {"triangle_tests_per_ray", "1", "triangles tested a ray", true},
      {"hit_share", "1", "share of the rays that hit something", true},
      {"leaks", "1", "rays that slipped between triangles, of a tracer that is not watertight", true},
      {"ray_count", "1", "rays of the workload", true},
      {break_even_quantity, "rays", "numbers of rays for which a method is the fastest of its table, building included", true},
  };
  return all;
}

std::vector<Quantity> metric_quantities(std::string_view metric) {
  const MethodInfo& info = Registry::instance().get(Role::metric, metric).info;
  std::vector<Quantity> all;
  for (const MetricValueInfo& value : info.values) {
    all.push_back({value.name, value.unit, value.summary.empty() ? info.summary : value.summary, false, value.axis});
  }
  return all;
}

std::string build_part_quantity(std::string_view part) { return "build_time:" + std::string(part); }

std::vector<Quantity> build_part_quantities() {
  std::vector<Quantity> all;
  for (const Registry::Entry* entry : Registry::instance().entries()) {
    for (const std::string& part : entry->info.parts) {
      const std::string name = build_part_quantity(part);
      const auto same = [&name](const Quantity& q) { return q.name == name; };
      if (std::none_of(all.begin(), all.end(), same)) all.push_back({name, "s", "a part of the builder's time on its device"});
    }
  }
  return all;
}

std::optional<double> unit_factor(std::string_view from, std::string_view to) {
  if (from == to) return 1;
  for (const UnitFamily& family : unit_families) {
    const double source = family.factor_of(from);
    const double target = family.factor_of(to);
    if (source > 0 && target > 0) return source / target;
  }
  return std::nullopt;
}

std::vector<std::string> units_for(std::string_view from) {
  std::vector<std::string> names{std::string(from)};
  for (const UnitFamily& family : unit_families) {
    if (family.factor_of(from) == 0) continue;
    for (const Unit& unit : family.units) {
      if (unit.name != from && !unit.name.empty() && unit.name != "1") names.emplace_back(unit.name);
    }
  }
  return names;
}

}  // namespace raystudy
