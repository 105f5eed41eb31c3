#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "harness/report/label_layout.h"
#include "harness/report/plot.h"
#include "harness/spec/reading.h"

namespace raystudy {
namespace {

constexpr double panel_width = 520;
constexpr double panel_height = 380;
constexpr double font_size = 11;

/// A method in a panel.
struct Contender {
  std::string method;
  std::string group;  ///< its builder's name
  double build = 0;   ///< ms
  double trace = 0;   ///< ns a ray
  bool on_front = false;
};

struct Panel {
  std::string title;
  std::vector<Contender> contenders;
};

/// A logarithmic axis over its numbers, with room for labels beside the outermost.
class LogAxis {
 public:
  LogAxis(double least, double most, double pixels) : low_(std::log10(least)), high_(std::log10(most)), pixels_(pixels) {
    const double shortest = 0.5;  // decades; less would blow noise up
    const double middle = (low_ + high_) / 2;
    const double half = std::max(high_ - low_, shortest) / 2 * 1.22;
    low_ = middle - half;
    high_ = middle + half;
  }
  [[nodiscard]] double pixel(double value) const { return (std::log10(value) - low_) / (high_ - low_) * pixels_; }
  [[nodiscard]] double value(double pixel) const { return std::pow(10.0, low_ + pixel / pixels_ * (high_ - low_)); }
  [[nodiscard]] Json domain() const { return {std::pow(10.0, low_), std::pow(10.0, high_)}; }
  /// 1, 2 and 5 of each decade; over many decades 1 only.
  [[nodiscard]] Json ticks() const {
    Json all = Json::array();
    for (int decade = static_cast<int>(std::floor(low_)); decade <= static_cast<int>(std::ceil(high_)); ++decade) {
      for (const double step : {1.0, 2.0, 5.0}) {
        if (step != 1 && high_ - low_ > 4) continue;
        const double tick = step * std::pow(10.0, decade);
        if (std::log10(tick) >= low_ && std::log10(tick) <= high_) all.push_back(tick);
      }
    }
    return all;
  }

 private:
  double low_;
  double high_;
  double pixels_;
};

/// Sorted by build time, those that no other beats in both times marked.
void mark_front(std::vector<Contender>& contenders) {
  std::sort(contenders.begin(), contenders.end(),
            [](const Contender& a, const Contender& b) { return std::tie(a.build, a.trace) < std::tie(b.build, b.trace); });
  double fastest = std::numeric_limits<double>::infinity();
  for (Contender& contender : contenders) {
    contender.on_front = contender.trace < fastest;
    fastest = std::min(fastest, contender.trace);
  }
}

std::vector<Contender> contenders_of(const FigureSpec& figure, const Report& report, const std::string& scene,
                                     const std::string& workload, std::vector<std::string>& gaps) {
  std::vector<Contender> contenders;
  for (const std::string& method : figure.methods) {
    const CellResult* built = build_result(report, scene, method, gaps);
    const CellResult* traced = built == nullptr ? nullptr : traced_result(report, figure, scene, method, workload, gaps);
    if (traced == nullptr) continue;
    const auto build = built->values.find("total_time");
    const auto rate = traced->values.find("trace_rate");
    if (build == built->values.end() || rate == traced->values.end() || !(build->second.median() > 0)) {
      gaps.push_back(fmt::format("{}, {}, {}: no times", scene, method, workload));
      continue;
    }
    const std::vector<PipelineSpec>& pipelines = report.plan().pipelines;
    contenders.push_back({method, pipelines[*index_of(pipelines, method)].builder.name, build->second.median() * 1e3,
                          1e9 / rate->second.median(), false});
  }
  mark_front(contenders);
  return contenders;
}

/// The corners of the stairs through the front.
std::vector<std::pair<double, double>> stairs(const std::vector<Contender>& contenders) {
  std::vector<std::pair<double, double>> corners;
  for (const Contender& c : contenders) {
    if (!c.on_front) continue;
    if (!corners.empty()) corners.emplace_back(c.build, corners.back().second);
    corners.emplace_back(c.build, c.trace);
  }
  return corners;
}

Json channel(const char* field, const LogAxis& axis, const std::string& title) {
  return {{"field", field},
          {"type", "quantitative"},
          {"title", title},
          {"scale", {{"type", "log"}, {"domain", axis.domain()}, {"nice", false}}},
          {"axis", {{"values", axis.ticks()}, {"format", "~r"}, {"labelOverlap", false}}}};
}

Json layer(Json rows, Json mark, Json encoding) {
  return {{"data", {{"values", std::move(rows)}}}, {"mark", std::move(mark)}, {"encoding", std::move(encoding)}};
}

/// Labels where there is room, the front's first, and thin lines to those that stand apart.
void add_labels(const Panel& panel, const LogAxis& x, const LogAxis& y, const Json& place, Json& layers) {
  std::vector<const Contender*> order;
  order.reserve(panel.contenders.size());
  for (const Contender& c : panel.contenders) order.push_back(&c);
  std::stable_sort(order.begin(), order.end(), [](const Contender* a, const Contender* b) { return a->on_front > b->on_front; });
  const auto pixels = [&](double build, double trace) { return PanelPoint{x.pixel(build), panel_height - y.pixel(trace)}; };
  std::vector<LabelRequest> requests;
  requests.reserve(order.size());
  for (const Contender* c : order) requests.push_back({pixels(c->build, c->trace), c->method});
  std::vector<PanelPoint> curve;
  curve.reserve(2 * order.size());
  for (const auto& [build, trace] : stairs(panel.contenders)) curve.push_back(pixels(build, trace));
  const std::vector<PlacedLabel> placed = place_labels(requests, curve, {panel_width, panel_height, font_size, 6});
  Json texts = Json::array();
  Json lines = Json::array();
  const auto back = [&](PanelPoint p) { return std::pair{x.value(p.x), y.value(panel_height - p.y)}; };
  for (std::size_t i = 0; i < placed.size(); ++i) {
    const auto [left, middle] = back(placed[i].left);
    texts.push_back({{"x", left}, {"y", middle}, {"method", requests[i].text}, {"front", order[i]->on_front}});
    if (!placed[i].has_line) continue;
    const auto [x1, y1] = back(placed[i].from);
    const auto [x2, y2] = back(placed[i].to);
    lines.push_back({{"x", x1}, {"y", y1}, {"x2", x2}, {"y2", y2}});
  }
  Json line = place;
  line.update({{"x2", {{"field", "x2"}}}, {"y2", {{"field", "y2"}}}});
  if (!lines.empty()) {
    layers.push_back(layer(std::move(lines), {{"type", "rule"}, {"color", "#aaaaaa"}, {"strokeWidth", 0.75}}, line));
  }
  Json text = place;
  text["text"] = {{"field", "method"}, {"type", "nominal"}};
  text["color"] = {{"condition", {{"test", "datum.front"}, {"value", "#111111"}}}, {"value", "#777777"}};
  layers.push_back(
      layer(std::move(texts), {{"type", "text"}, {"align", "left"}, {"baseline", "middle"}, {"fontSize", font_size}}, text));
}

/// Colour and form by builder: Embree's own points are dark diamonds, so that they stand out among all others.
Json group_channel(const std::vector<std::string>& groups, bool forms) {
  static constexpr std::array<const char*, 7> colors{"#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#8c564b"};
  static constexpr std::array<const char*, 6> shapes{"circle",        "square", "triangle-up",
                                                     "triangle-down", "cross",  "triangle-right"};
  Json range = Json::array();
  std::size_t others = 0;
  for (const std::string& group : groups) {
    const bool is_embree = group == "embree";
    if (forms) {
      range.push_back(is_embree ? "diamond" : shapes.at(others % shapes.size()));
    } else {
      range.push_back(is_embree ? "#222222" : colors.at(others % colors.size()));
    }
    if (!is_embree) ++others;
  }
  return {{"field", "builder"},
          {"type", "nominal"},
          {"scale", {{"domain", groups}, {"range", range}}},
          {"legend", {{"title", "builder"}, {"symbolType", nullptr}, {"symbolSize", 90}, {"columns", 8}}}};
}

Json draw(const Panel& panel, const std::string& workload, const std::vector<std::string>& groups) {
  const auto bounds = [&panel](double Contender::*time) {
    const auto [least, most] = std::minmax_element(panel.contenders.begin(), panel.contenders.end(),
                                                   [time](const auto& a, const auto& b) { return a.*time < b.*time; });
    return std::pair{(*least).*time, (*most).*time};
  };
  const auto [shortest, longest] = bounds(&Contender::build);
  const auto [fastest, slowest] = bounds(&Contender::trace);
  const LogAxis x(shortest, longest, panel_width);
  const LogAxis y(fastest, slowest, panel_height);
  const Json place{{"x", channel("x", x, "time to build [ms]")},
                   {"y", channel("y", y, fmt::format("time to trace a ray, {} [ns]", words(workload)))}};
  Json corners = Json::array();
  for (const auto& [build, trace] : stairs(panel.contenders)) {
    corners.push_back({{"x", build}, {"y", trace}, {"order", corners.size()}});
  }
  Json points = Json::array();
  for (const Contender& c : panel.contenders) {
    points.push_back({{"method", c.method}, {"builder", c.group}, {"x", c.build}, {"y", c.trace}, {"front", c.on_front}});
  }
  Json line = place;
  line["order"] = {{"field", "order"}, {"type", "quantitative"}};
  Json point = place;
  point["color"] = group_channel(groups, false);
  point["shape"] = group_channel(groups, true);
  point["fillOpacity"] = {{"condition", {{"test", "datum.front"}, {"value", 1}}}, {"value", 0.35}};
  Json layers = Json::array();
  layers.push_back(layer(std::move(corners), {{"type", "line"}, {"color", "#9a9a9a"}, {"strokeWidth", 1.5}}, line));
  layers.push_back(layer(std::move(points),
                         {{"type", "point"}, {"filled", true}, {"size", 95}, {"strokeWidth", 1.25}, {"opacity", 1}}, point));
  add_labels(panel, x, y, place, layers);
  return {{"title", {{"text", panel.title}, {"fontSize", 13}, {"fontWeight", "normal"}, {"anchor", "middle"}, {"offset", 6}}},
          {"width", panel_width},
          {"height", panel_height},
          {"layer", std::move(layers)}};
}

}  // namespace

Json pareto_plot(const FigureSpec& figure, const Report& report, std::vector<std::string>& gaps) {
  std::vector<std::string> groups;
  std::vector<std::pair<Panel, std::string>> panels;
  for (const std::string& scene : figure.scenes) {
    for (const std::string& workload : figure.workloads) {
      Panel panel{scene, contenders_of(figure, report, scene, workload, gaps)};
      if (panel.contenders.empty()) continue;
      for (const Contender& c : panel.contenders) {
        if (std::find(groups.begin(), groups.end(), c.group) == groups.end()) groups.push_back(c.group);
      }
      panels.emplace_back(std::move(panel), workload);
    }
  }
  if (panels.empty()) return {};
  std::sort(groups.begin(), groups.end());
  Json spec = document(figure, Json::array());
  spec.erase("data");
  spec["title"] = {
      {"text", figure.caption},
      {"subtitle",
       Json::array({"The line is the front: nothing below and to the left of it. Pale points are beaten in both times."})}};
  spec["concat"] = Json::array();
  for (const auto& [panel, workload] : panels) spec["concat"].push_back(draw(panel, workload, groups));
  spec["columns"] = 2;
  spec["spacing"] = 36;
  return spec;
}

}  // namespace raystudy
