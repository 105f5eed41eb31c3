#include "harness/report/plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <sstream>
#include <utility>

#include "harness/spec/reading.h"

namespace raystudy {
namespace {

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

}  // namespace

Json document(const FigureSpec& figure, Json rows) {
  Json spec{{"$schema", "https://vega.github.io/schema/vega-lite/v5.json"}, {"padding", 12}, {"config", config()}};
  if (!figure.caption.empty()) spec["title"] = figure.caption;
  spec["data"] = {{"values", std::move(rows)}};
  return spec;
}

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

std::string words(std::string name) {
  std::replace(name.begin(), name.end(), '_', ' ');
  return name;
}

namespace {

/// A result that is done, or null with the reason among `gaps`, each once.
const CellResult* done_result(const CellResult* found, const std::string& place, std::vector<std::string>& gaps) {
  if (found != nullptr && found->status == CellStatus::done) return found;
  std::string gap = fmt::format("{}: {}", place, found == nullptr ? "not run" : found->reason);
  if (found != nullptr && found->status == CellStatus::missing) gap = found->reason;  // names the scene
  if (std::find(gaps.begin(), gaps.end(), gap) == gaps.end()) gaps.push_back(gap);
  return nullptr;
}

}  // namespace

const CellResult* build_result(const Report& report, const std::string& scene, const std::string& method,
                               std::vector<std::string>& gaps) {
  return done_result(report.results().find(scene, method), fmt::format("{}, {}", scene, method), gaps);
}

const CellResult* traced_result(const Report& report, const FigureSpec& figure, const std::string& scene,
                                const std::string& method, const std::string& workload, std::vector<std::string>& gaps) {
  std::string tracer = figure.tracer;
  if (tracer == own_tracer) tracer = report.plan().pipelines[*index_of(report.plan().pipelines, method)].tracers.front();
  return done_result(report.results().find(scene, method, tracer, workload),
                     fmt::format("{}, {}, {}, {}", scene, method, tracer, workload), gaps);
}

const Series* series_of(const CellResult& result, const std::string& name, std::vector<std::string>& gaps) {
  const auto found = result.series.find(name);
  if (found != result.series.end() && !found->second.x.empty()) return &found->second;
  gaps.push_back(fmt::format("{}, {}: no series '{}'", result.scene, result.method, name));
  return nullptr;
}

Json panels(const FigureSpec& figure, const std::vector<std::string>& scenes, Json rows, const Json& panel,
            const std::string& explained) {
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

std::string option_of(const FigureSpec& figure, const std::string& name) {
  const auto found = figure.options.find(name);
  return found == figure.options.end() ? std::string{} : found->second;
}

bool is_logarithmic(const FigureSpec& figure, const std::string& option) { return option_of(figure, option) == "true"; }

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
  Json spec;
  if (figure.kind == "depth-histogram") {
    spec = depth_histogram(figure, report, gaps);
  } else if (figure.kind == "pareto") {
    spec = pareto_plot(figure, report, gaps);
  } else if (option_of(figure, "x") == "triangles") {
    spec = scaling_plot(figure, report, gaps);
  } else {
    spec = series_plot(figure, report, gaps);
  }
  return spec.is_null() || spec.empty() ? "" : spec.dump(1) + '\n';
}

}  // namespace raystudy
