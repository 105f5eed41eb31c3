#include <array>
#include <utility>

#include "harness/report/plot.h"

namespace raystudy {

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

}  // namespace raystudy
