#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "harness/report/plot.h"
#include "harness/report/statistics.h"

namespace raystudy {
namespace {

constexpr double panel_height = 300;

/// One curve over the triangles, both axes logarithmic.
struct Growth {
  std::string scene;
  std::string method;
  std::vector<double> triangles;  ///< > 0
  std::vector<double> values;     ///< > 0
};

void add_point(std::vector<Growth>& growths, const Json& row) {
  const double x = row["x"];
  const double y = row["y"];
  if (x <= 0 || y <= 0) return;
  const std::string scene = row["scene"];
  const std::string method = row["method"];
  auto found =
      std::find_if(growths.begin(), growths.end(), [&](const Growth& g) { return g.scene == scene && g.method == method; });
  if (found == growths.end()) found = growths.insert(found, Growth{scene, method, {}, {}});
  found->triangles.push_back(x);
  found->values.push_back(y);
}

/// 0: none.
double reference_exponent(const FigureSpec& figure) {
  const std::string option = option_of(figure, "reference_exponent");
  return option.empty() ? 0 : std::stod(option);
}

/// Moves the ends of curves of one panel apart, so that a line of text fits beside each: in turns every two neighbours that are
/// too close give way, each by half.
void move_apart(std::vector<double*> ends, const std::vector<const Growth*>& curves) {
  double least = std::numeric_limits<double>::infinity();
  double most = 0;
  for (const Growth* growth : curves) {
    for (const double value : growth->values) {
      least = std::min(least, value);
      most = std::max(most, value);
    }
  }
  constexpr double line_height = 14;  // pixels, of panel_height
  const double apart = std::log(most / least) * line_height / panel_height;
  std::sort(ends.begin(), ends.end(), [](const double* a, const double* b) { return *a < *b; });
  for (int turn = 0; turn < 100; ++turn) {
    for (std::size_t i = 1; i < ends.size(); ++i) {
      const double lack = apart - std::log(*ends[i] / *ends[i - 1]);
      if (lack <= 0) continue;
      *ends[i - 1] *= std::exp(-lack / 2);
      *ends[i] *= std::exp(lack / 2);
    }
  }
}

/// By growth, the height at which its power is written: where the curve ends, or near there.
std::vector<double> label_heights(const std::vector<Growth>& growths) {
  std::vector<double> heights;
  std::map<std::string, std::pair<std::vector<double*>, std::vector<const Growth*>>> panels;
  heights.reserve(growths.size());  // the pointers stay
  for (const Growth& growth : growths) {
    const auto most = std::max_element(growth.triangles.begin(), growth.triangles.end()) - growth.triangles.begin();
    heights.push_back(growth.values[static_cast<std::size_t>(most)]);
    panels[growth.scene].first.push_back(&heights.back());
    panels[growth.scene].second.push_back(&growth);
  }
  for (auto& [scene, panel] : panels) move_apart(panel.first, panel.second);
  return heights;
}

/// Says beside each curve with which power of the triangles it grows, and draws the power that it is to be compared with. False
/// where no curve has points enough: layers without data would be mistakes of the figure.
bool add_growth(const FigureSpec& figure, const Json& encoding, const std::vector<Growth>& growths, Json& rows, Json& layers) {
  const double reference = reference_exponent(figure);
  const std::vector<double> heights = label_heights(growths);
  const std::size_t measured = rows.size();
  for (std::size_t i = 0; i < growths.size(); ++i) {
    const Growth& growth = growths[i];
    const std::optional<PowerFit> fit = fit_power(growth.triangles, growth.values);
    if (!fit || !fit->standard_error) continue;
    const auto [least, most] = std::minmax_element(growth.triangles.begin(), growth.triangles.end());
    const double start = growth.values[static_cast<std::size_t>(least - growth.triangles.begin())];
    const Json common{{"scene", growth.scene}, {"method", growth.method}};
    const auto add = [&rows, &common](double x, double y, const char* field, const Json& value) {
      Json row = common;
      row.update({{"x", x}, {"y", y}, {field, value}});
      rows.push_back(std::move(row));
    };
    add(*most, heights[i], "exponent", fmt::format("N^{:.2f}", fit->exponent));
    if (reference <= 0) continue;
    add(*least, start, "reference", growth.method);
    add(*most, start * std::pow(*most / *least, reference), "reference", growth.method);
  }
  if (rows.size() == measured) return false;
  Json fitted{{"x", encoding["x"]}, {"y", encoding["y"]}, {"color", encoding["color"]}};
  fitted["text"] = {{"field", "exponent"}, {"type", "nominal"}};
  layers.push_back({{"transform", Json::array({{{"filter", "isValid(datum.exponent)"}}})},
                    {"mark", {{"type", "text"}, {"align", "left"}, {"baseline", "middle"}, {"dx", 10}, {"fontSize", 12}}},
                    {"encoding", std::move(fitted)}});
  if (reference <= 0) return true;
  Json line{{"x", encoding["x"]}, {"y", encoding["y"]}, {"detail", {{"field", "reference"}, {"type", "nominal"}}}};
  const Json layer{{"transform", Json::array({{{"filter", "isValid(datum.reference)"}}})},
                   {"mark", {{"type", "line"}, {"color", "#999999"}, {"strokeWidth", 1.25}, {"strokeDash", {4, 3}}}},
                   {"encoding", std::move(line)}};
  layers.insert(layers.begin(), layer);
  return true;
}

}  // namespace

Json scaling_plot(const FigureSpec& figure, const Report& report, std::vector<std::string>& gaps) {
  const std::string quantity = option_of(figure, "y");
  Json rows = Json::array();
  std::vector<std::string> bases;
  std::vector<Growth> growths;
  std::string unit;
  for (const std::string& scene : figure.scenes) {
    const auto spec = std::find_if(report.plan().scenes.begin(), report.plan().scenes.end(),
                                   [&](const SceneSpec& s) { return s.label == scene; });
    const std::string base = spec == report.plan().scenes.end() || spec->base.empty() ? scene : spec->base;
    for (const std::string& method : figure.methods) {
      const CellResult* built = build_result(report, scene, method, gaps);
      if (built == nullptr) continue;
      const CellResult* result =
          figure.tracer.empty() ? built : traced_result(report, figure, scene, method, figure.workloads.front(), gaps);
      if (result == nullptr) continue;
      const auto triangles = built->values.find("triangles");
      const auto value = result->values.find(quantity);
      if (triangles == built->values.end() || value == result->values.end() || value->second.samples.empty()) {
        gaps.push_back(fmt::format("{}, {}: no '{}'", scene, method, quantity));
        continue;
      }
      unit = value->second.unit;
      Json row{{"scene", base}, {"method", method}, {"x", triangles->second.median()}, {"y", value->second.median()}};
      if (value->second.value_class != ValueClass::exact) {
        if (const auto i = Bootstrapped::median(value->second.samples, 1).estimate().interval) {
          row["low"] = i->low;
          row["high"] = i->high;
        }
      }
      if (std::find(bases.begin(), bases.end(), base) == bases.end()) bases.push_back(base);
      add_point(growths, row);
      rows.push_back(std::move(row));
    }
  }
  if (rows.empty()) return {};
  Json encoding{{"x", axis(figure, "x", "triangles", "log_x", "~s")},
                {"y", axis(figure, "y", with_unit(words(quantity), unit), "log_y", "~g")}};
  Json intervals = encoding;
  intervals["y"]["field"] = "low";
  intervals["y2"] = {{"field", "high"}};
  add_styles(encoding, figure);
  intervals["color"] = encoding["color"];
  Json points = encoding;
  points.erase("strokeDash");
  const Json measured = Json::array({{{"filter", "!isValid(datum.exponent) && !isValid(datum.reference)"}}});
  Json layers = Json::array({{{"transform", measured}, {"mark", "line"}, {"encoding", encoding}},
                             {{"transform", measured},
                              {"mark", {{"type", "point"}, {"filled", true}, {"size", 45}, {"opacity", 1}}},
                              {"encoding", points}}});
  if (std::any_of(rows.begin(), rows.end(), [](const Json& row) { return row.contains("low"); })) {
    layers.push_back({{"transform", Json::array({{{"filter", "isValid(datum.low)"}}})},
                      {"mark", {{"type", "rule"}, {"strokeWidth", 1.5}}},
                      {"encoding", intervals}});
  }
  std::string explained;
  if (is_logarithmic(figure, "log_x") && is_logarithmic(figure, "log_y") && add_growth(figure, encoding, growths, rows, layers)) {
    explained = "N^x: the power of the triangles that fits best";
    if (const double x = reference_exponent(figure); x > 0) explained += fmt::format("; grey: N^{:g}", x);
  }
  return panels(figure, bases, std::move(rows), {{"width", 420}, {"height", panel_height}, {"layer", std::move(layers)}},
                explained);
}

}  // namespace raystudy
