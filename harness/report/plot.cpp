#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>
#include <utility>

#include "harness/report/figure.h"
#include "harness/report/statistics.h"
#include "harness/spec/quantity.h"

namespace raystudy {
namespace {

using Json = nlohmann::ordered_json;

/// Okabe and Ito's palette without its yellow, which is too pale for a line.
constexpr std::array<const char*, 7> palette{"#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000"};
constexpr std::array<const char*, 10> named_colors{"red",   "green", "blue", "orange",  "purple",
                                                   "brown", "black", "gray", "magenta", "teal"};

bool is_color(const std::string& word) {
  if (word.size() == 7 && word.front() == '#') return word.find_first_not_of("0123456789abcdefABCDEF", 1) == std::string::npos;
  return std::find(named_colors.begin(), named_colors.end(), word) != named_colors.end();
}

Json config() {
  return {{"font", "DejaVu Sans, Helvetica, Arial, sans-serif"},
          {"background", "white"},
          {"view", {{"stroke", nullptr}}},
          {"axis",
           {{"labelFontSize", 12},
            {"titleFontSize", 13},
            {"titleFontWeight", "normal"},
            {"titlePadding", 10},
            {"gridColor", "#e4e4e4"},
            {"domainColor", "#555555"},
            {"tickColor", "#555555"}}},
          {"legend",
           {{"labelFontSize", 12},
            {"titleFontSize", 12},
            {"symbolStrokeWidth", 2.5},
            {"symbolSize", 700},
            {"labelLimit", 400},
            {"orient", "bottom"}}},
          {"title",
           {{"fontSize", 15},
            {"anchor", "start"},
            {"fontWeight", "bold"},
            {"offset", 14},
            {"subtitleFontSize", 12},
            {"subtitlePadding", 6}}},
          {"line", {{"strokeWidth", 2.25}, {"strokeJoin", "round"}}}};
}

Json document(const FigureSpec& figure, Json rows) {
  Json spec{{"$schema", "https://vega.github.io/schema/vega-lite/v5.json"}, {"padding", 12}, {"config", config()}};
  if (!figure.caption.empty()) spec["title"] = figure.caption;
  spec["data"] = {{"values", std::move(rows)}};
  return spec;
}

/// Colour and dash by method, with one legend for both.
void add_styles(Json& encoding, const FigureSpec& figure) {
  Json names = Json::array();
  Json colors = Json::array();
  Json dashes = Json::array();
  for (std::size_t i = 0; i < figure.methods.size(); ++i) {
    const CurveStyle style = curve_style(figure, i);
    names.push_back(figure.methods[i]);
    colors.push_back(style.color);
    dashes.push_back(style.dash.empty() ? Json::array({1, 0}) : Json(style.dash));
  }
  const Json legend{{"title", nullptr}, {"symbolType", "stroke"}};
  encoding["color"] = {
      {"field", "method"}, {"type", "nominal"}, {"scale", {{"domain", names}, {"range", colors}}}, {"legend", legend}};
  encoding["strokeDash"] = {
      {"field", "method"}, {"type", "nominal"}, {"scale", {{"domain", names}, {"range", dashes}}}, {"legend", legend}};
}

std::string with_unit(const std::string& text, const std::string& unit) {
  return unit.empty() || unit == "1" ? text : fmt::format("{} [{}]", text, unit);
}

/// "cost_over_time" → "cost over time".
std::string words(std::string name) {
  std::replace(name.begin(), name.end(), '_', ' ');
  return name;
}

/// The build cell's result, or null with the reason among `gaps`.
const CellResult* build_result(const Report& report, const std::string& scene, const std::string& method,
                               std::vector<std::string>& gaps) {
  const CellResult* found = report.results().find(scene, method);
  std::string gap;
  if (found == nullptr) gap = fmt::format("{}, {}: not run", scene, method);
  if (found != nullptr && found->status != CellStatus::done) {
    gap = found->status == CellStatus::missing ? found->reason : fmt::format("{}, {}: {}", scene, method, found->reason);
    found = nullptr;
  }
  if (!gap.empty() && std::find(gaps.begin(), gaps.end(), gap) == gaps.end()) gaps.push_back(gap);
  return found;
}

const Series* series_of(const CellResult& result, const std::string& name, std::vector<std::string>& gaps) {
  const auto found = result.series.find(name);
  if (found != result.series.end() && !found->second.x.empty()) return &found->second;
  gaps.push_back(fmt::format("{}, {}: no series '{}'", result.scene, result.method, name));
  return nullptr;
}

/// Panels beside each other, one a scene where there are several. `explained` stands below the caption.
Json panels(const FigureSpec& figure, const std::vector<std::string>& scenes, Json rows, const Json& panel,
            const std::string& explained = {}) {
  Json spec = document(figure, std::move(rows));
  Json subtitle = Json::array();
  if (scenes.size() < 2) subtitle.push_back(scenes.front());
  if (!explained.empty()) subtitle.push_back(explained);
  if (!subtitle.empty()) spec["title"] = {{"text", figure.caption}, {"subtitle", std::move(subtitle)}};
  if (scenes.size() < 2) {
    spec.update(panel);
    return spec;
  }
  spec["facet"] = {
      {"field", "scene"}, {"type", "nominal"}, {"sort", scenes}, {"header", {{"title", nullptr}, {"labelFontSize", 13}}}};
  spec["columns"] = 2;
  spec["spec"] = panel;
  // Each scene has costs of its own size.
  spec["resolve"] = {{"scale", {{"x", "independent"}, {"y", "independent"}}}};
  return spec;
}

Json depth_histogram(const FigureSpec& figure, const Report& report, std::vector<std::string>& gaps) {
  static const std::array<std::pair<std::string, std::string>, 2> sides{
      {{"inner_area_by_depth", "inner nodes"}, {"leaf_area_by_depth", "leaves"}}};
  Json rows = Json::array();
  for (const std::string& scene : figure.scenes) {
    for (const std::string& method : figure.methods) {
      const CellResult* result = build_result(report, scene, method, gaps);
      if (result == nullptr) continue;
      for (const auto& [name, nodes] : sides) {
        const Series* series = series_of(*result, name, gaps);
        if (series == nullptr) continue;
        for (std::size_t i = 0; i < series->x.size(); ++i) {
          rows.push_back(
              {{"scene", scene}, {"method", method}, {"nodes", nodes}, {"depth", series->x[i]}, {"area", series->y[i]}});
        }
      }
    }
  }
  if (rows.empty()) return {};
  Json encoding{{"x",
                 {{"field", "depth"},
                  {"type", "quantitative"},
                  {"title", "depth"},
                  {"axis", {{"tickMinStep", 1}, {"format", "d"}, {"labelFlush", false}}}}},
                {"y", {{"field", "area"}, {"type", "quantitative"}, {"title", "sum of areas / root area"}}}};
  add_styles(encoding, figure);
  Json spec = document(figure, std::move(rows));
  const Json header{{"title", nullptr}, {"labelFontSize", 13}};
  spec["facet"]["column"] = {
      {"field", "nodes"}, {"type", "nominal"}, {"sort", {sides[0].second, sides[1].second}}, {"header", header}};
  if (figure.scenes.size() > 1) {
    spec["facet"]["row"] = {{"field", "scene"}, {"type", "nominal"}, {"sort", figure.scenes}, {"header", header}};
  }
  spec["spec"] = {{"width", 380}, {"height", 280}, {"mark", "line"}, {"encoding", std::move(encoding)}};
  spec["resolve"] = {{"scale", {{"y", "independent"}}}, {"axis", {{"x", "independent"}}}};
  return spec;
}

bool is_logarithmic(const FigureSpec& figure, const std::string& option) {
  return figure.options.contains(option) && figure.options.at(option) == "true";
}

/// A position channel. `logarithmic` names the figure's option.
Json axis(const FigureSpec& figure, const std::string& field, const std::string& title, const std::string& logarithmic,
          const std::string& format) {
  Json channel{{"field", field}, {"type", "quantitative"}, {"title", title}, {"axis", {{"format", format}}}};
  if (!is_logarithmic(figure, logarithmic)) {
    channel["scale"] = {{"zero", false}, {"nice", true}};
    return channel;
  }
  channel["scale"] = {{"type", "log"}, {"nice", false}, {"padding", 12}};
  // Labels at 1, 2 and 5 of each decade only: Vega's own choice leaves gaps and odd ones.
  channel["axis"]["labelOverlap"] = false;
  channel["axis"]["labelExpr"] = fmt::format(
      "indexof([1, 2, 5], round(datum.value / pow(10, floor(log(datum.value) / LN10 + 1e-9)))) >= 0 ? "
      "format(datum.value, '{}') : ''",
      format);
  return channel;
}

/// A series over its own axis. A logarithmic axis has no place for 0: such points are left out, and that is said.
Json series_plot(const FigureSpec& figure, const Report& report, const std::string& quantity, std::vector<std::string>& gaps) {
  Json rows = Json::array();
  std::vector<std::string> scenes;
  Series first;
  std::size_t left_out = 0;
  for (const std::string& scene : figure.scenes) {
    for (const std::string& method : figure.methods) {
      const CellResult* result = build_result(report, scene, method, gaps);
      const Series* series = result == nullptr ? nullptr : series_of(*result, quantity, gaps);
      if (series == nullptr) continue;
      if (first.x.empty()) first = *series;
      if (scenes.empty() || scenes.back() != scene) scenes.push_back(scene);
      for (std::size_t i = 0; i < series->x.size(); ++i) {
        if ((is_logarithmic(figure, "log_x") && series->x[i] <= 0) || (is_logarithmic(figure, "log_y") && series->y[i] <= 0)) {
          ++left_out;
          continue;
        }
        rows.push_back({{"scene", scene}, {"method", method}, {"x", series->x[i]}, {"y", series->y[i]}});
      }
    }
  }
  if (rows.empty()) return {};
  if (left_out > 0) gaps.push_back(fmt::format("{} points at 0 have no place on a logarithmic axis", left_out));
  const std::string x_name = first.x_name == "seconds" ? "time" : words(first.x_name);
  const std::string y_name = quantity == "cost_over_time" ? "cost" : words(quantity);
  Json encoding{{"x", axis(figure, "x", with_unit(x_name, first.x_unit), "log_x", "~g")},
                {"y", axis(figure, "y", with_unit(y_name, first.unit), "log_y", "~g")}};
  add_styles(encoding, figure);
  return panels(figure, scenes, std::move(rows),
                {{"width", 420},
                 {"height", 300},
                 {"mark", {{"type", "line"}, {"interpolate", "step-after"}}},
                 {"encoding", std::move(encoding)}});
}

/// One curve over the triangles, both axes logarithmic.
struct Growth {
  std::string scene;
  std::string method;
  std::vector<double> triangles;  ///< > 0
  std::vector<double> values;     ///< > 0

  /// The slope of the least-squares line through the logarithms: values grow as triangles^exponent.
  [[nodiscard]] double exponent() const {
    const auto n = static_cast<double>(triangles.size());
    double x_sum = 0;
    double y_sum = 0;
    double xx_sum = 0;
    double xy_sum = 0;
    for (std::size_t i = 0; i < triangles.size(); ++i) {
      const double x = std::log(triangles[i]);
      const double y = std::log(values[i]);
      x_sum += x;
      y_sum += y;
      xx_sum += x * x;
      xy_sum += x * y;
    }
    return (n * xy_sum - x_sum * y_sum) / (n * xx_sum - x_sum * x_sum);
  }
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
  const auto option = figure.options.find("reference_exponent");
  return option == figure.options.end() ? 0 : std::stod(option->second);
}

/// Says beside each curve with which power of the triangles it grows, and draws the power that it is to be compared with.
void add_growth(const FigureSpec& figure, const Json& encoding, const std::vector<Growth>& growths, Json& rows, Json& layers) {
  const double reference = reference_exponent(figure);
  for (const Growth& growth : growths) {
    const auto [least, most] = std::minmax_element(growth.triangles.begin(), growth.triangles.end());
    if (growth.triangles.size() < 3 || *least == *most) continue;
    const double start = growth.values[static_cast<std::size_t>(least - growth.triangles.begin())];
    const double end = growth.values[static_cast<std::size_t>(most - growth.triangles.begin())];
    const Json common{{"scene", growth.scene}, {"method", growth.method}};
    const auto add = [&rows, &common](double x, double y, const char* field, const Json& value) {
      Json row = common;
      row.update({{"x", x}, {"y", y}, {field, value}});
      rows.push_back(std::move(row));
    };
    add(*most, end, "exponent", fmt::format("N^{:.2f}", growth.exponent()));
    if (reference <= 0) continue;
    add(*least, start, "reference", growth.method);
    add(*most, start * std::pow(*most / *least, reference), "reference", growth.method);
  }
  Json fitted{{"x", encoding["x"]}, {"y", encoding["y"]}, {"color", encoding["color"]}};
  fitted["text"] = {{"field", "exponent"}, {"type", "nominal"}};
  layers.push_back({{"transform", Json::array({{{"filter", "isValid(datum.exponent)"}}})},
                    {"mark", {{"type", "text"}, {"align", "left"}, {"baseline", "middle"}, {"dx", 10}, {"fontSize", 12}}},
                    {"encoding", std::move(fitted)}});
  if (reference <= 0) return;
  Json line{{"x", encoding["x"]}, {"y", encoding["y"]}, {"detail", {{"field", "reference"}, {"type", "nominal"}}}};
  const Json layer{{"transform", Json::array({{{"filter", "isValid(datum.reference)"}}})},
                   {"mark", {{"type", "line"}, {"color", "#999999"}, {"strokeWidth", 1.25}, {"strokeDash", {4, 3}}}},
                   {"encoding", std::move(line)}};
  layers.insert(layers.begin(), layer);
}

/// A single number over the triangles of the scenes: a curve for each method, a panel for each scene of a sweep.
Json scaling_plot(const FigureSpec& figure, const Report& report, const std::string& quantity, std::vector<std::string>& gaps) {
  Json rows = Json::array();
  std::vector<std::string> bases;
  std::vector<Growth> growths;
  std::string unit;
  for (const std::string& scene : figure.scenes) {
    const auto spec = std::find_if(report.plan().scenes.begin(), report.plan().scenes.end(),
                                   [&](const SceneSpec& s) { return s.label == scene; });
    const std::string base = spec == report.plan().scenes.end() || spec->base.empty() ? scene : spec->base;
    for (const std::string& method : figure.methods) {
      const CellResult* result = build_result(report, scene, method, gaps);
      if (result == nullptr) continue;
      const auto triangles = result->values.find("triangles");
      const auto value = result->values.find(quantity);
      if (triangles == result->values.end() || value == result->values.end() || value->second.samples.empty()) {
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
  if (is_logarithmic(figure, "log_x") && is_logarithmic(figure, "log_y")) {
    add_growth(figure, encoding, growths, rows, layers);
    explained = "N^x: the power of the triangles that fits best";
    if (const double x = reference_exponent(figure); x > 0) explained += fmt::format("; grey: N^{:g}", x);
  }
  return panels(figure, bases, std::move(rows), {{"width", 420}, {"height", 300}, {"layer", std::move(layers)}}, explained);
}

}  // namespace

CurveStyle curve_style(const FigureSpec& figure, std::size_t method) {
  CurveStyle style{palette[method % palette.size()], {}};
  const auto given = figure.styles.find(figure.methods.at(method));
  if (given == figure.styles.end()) return style;
  std::istringstream text(given->second);
  for (std::string word; text >> word;) {
    if (word == "dashed") {
      style.dash = {7, 4};
    } else if (word == "dotted") {
      style.dash = {2, 3};
    } else if (is_color(word)) {
      style.color = word;
    } else if (word != "solid") {
      throw Error(Diagnostic{figure.where,
                             fmt::format("style of '{}' in figure '{}' has '{}'", given->first, figure.name, word),
                             "a colour (#rrggbb or a name), then solid, dashed or dotted",
                             {}});
    }
  }
  return style;
}

std::string figure_spec(const FigureSpec& figure, const Report& report, std::vector<std::string>& gaps) {
  const auto option = [&](const std::string& name, const std::string& fallback) {
    const auto found = figure.options.find(name);
    return found == figure.options.end() ? fallback : found->second;
  };
  Json spec;
  if (figure.kind == "depth-histogram") {
    spec = depth_histogram(figure, report, gaps);
  } else if (option("x", "axis") == "triangles") {
    spec = scaling_plot(figure, report, option("y", "total_time"), gaps);
  } else {
    spec = series_plot(figure, report, option("y", "cost_over_time"), gaps);
  }
  return spec.is_null() || spec.empty() ? "" : spec.dump(1) + '\n';
}

}  // namespace raystudy
