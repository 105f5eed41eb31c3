#include "harness/report/slope.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

namespace raystudy {
namespace {

/// Nothing where no build on the scene has been measured.
std::optional<double> triangles_of(const ResultSet& results, const std::string& scene) {
  for (const CellResult& result : results.all()) {
    const auto found = result.scene == scene ? result.values.find("triangles") : result.values.end();
    if (result.scene == scene && found != result.values.end()) return found->second.median();
  }
  return std::nullopt;
}

}  // namespace

std::vector<const SceneSpec*> scenes_of(const Plan& plan, const std::string& base) {
  std::vector<const SceneSpec*> scenes;
  for (const SceneSpec& scene : plan.scenes) {
    if (scene.base == base) scenes.push_back(&scene);
  }
  return scenes;
}

std::vector<std::string> scene_bases(const Plan& plan, const std::vector<std::string>& labels) {
  std::vector<std::string> bases;
  for (const SceneSpec& scene : plan.scenes) {
    if (!labels.empty() && std::find(labels.begin(), labels.end(), scene.label) == labels.end()) continue;
    if (std::find(bases.begin(), bases.end(), scene.base) == bases.end()) bases.push_back(scene.base);
  }
  return bases;
}

ReportCell slope_cell(const ColumnSpec& column, const ValuePlace& place, const Plan& plan, const ResultSet& results) {
  ReportCell cell;
  std::vector<double> sizes;
  std::vector<double> values;
  std::vector<std::string> without;
  const CellResult* first = nullptr;
  std::string difference;
  for (const SceneSpec* scene : scenes_of(plan, place.scene)) {
    ValuePlace at_scene = place;
    at_scene.scene = scene->label;
    const FoundValue found = find_value(column, at_scene, column.unit, results);
    const std::optional<double> triangles = triangles_of(results, scene->label);
    if (!found.value || !triangles || !(found.value->value > 0)) {
      without.push_back(fmt::format("{} ({})", scene->label, found.value ? "0" : found.absence));
      if (cell.absence.empty()) cell.absence = found.absence;
      continue;
    }
    for (const CellResult* result : found.timed_results) {
      if (first == nullptr) first = result;
      if (difference.empty()) difference = machine_difference(*first, *result);
    }
    sizes.push_back(*triangles);
    values.push_back(found.value->value);
    cell.value_class = found.timed_results.empty() ? ValueClass::exact : ValueClass::ratio;
  }
  if (!sizes.empty() && !without.empty()) cell.reason = fmt::format("without {}", fmt::join(without, ", "));
  if (!difference.empty()) {
    cell.absence = "none";
    cell.reason = fmt::format("times of different machines have no slope: {}", difference);
    return cell;
  }
  const std::optional<PowerFit> fit = fit_power(sizes, values);
  if (!fit) {
    if (!sizes.empty()) cell.reason = joined("a slope needs scenes of two sizes", cell.reason);
    if (cell.absence.empty()) cell.absence = "none";
    return cell;
  }
  cell.absence.clear();
  cell.ours = Estimate{fit->exponent, {}};
  cell.shows_error = true;
  if (const auto error = fit->standard_error) {
    cell.ours->interval = Estimate::Interval{fit->exponent - *error, fit->exponent + *error};
  }
  return cell;
}

}  // namespace raystudy
