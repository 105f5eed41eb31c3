#include <fmt/format.h>

#include <utility>

#include "harness/report/plot.h"

namespace raystudy {

Json series_plot(const FigureSpec& figure, const Report& report, std::vector<std::string>& gaps) {
  const std::string quantity = option_of(figure, "y");
  Json rows = Json::array();
  std::vector<std::string> scenes;
  Series first;
  std::size_t left_out = 0;
  for (const std::string& scene : figure.scenes) {
    for (const std::string& method : figure.methods) {
      const CellResult* result = figure.workloads.empty()
                                     ? build_result(report, scene, method, gaps)
                                     : traced_result(report, figure, scene, method, figure.workloads.front(), gaps);
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
  // Rounded numbers where ticks are equally far apart: 400 and not 4e+2.
  const auto format = [&figure](const char* log) { return is_logarithmic(figure, log) ? "~g" : "~r"; };
  Json encoding{{"x", axis(figure, "x", with_unit(x_name, first.x_unit), "log_x", format("log_x"))},
                {"y", axis(figure, "y", with_unit(y_name, first.unit), "log_y", format("log_y"))}};
  add_styles(encoding, figure);
  return panels(figure, scenes, std::move(rows),
                {{"width", 420},
                 {"height", 300},
                 {"mark",
                  {{"type", "line"},
                   {"interpolate", first.x_name == "seconds" ? "step-after" : "linear"},
                   {"point", first.x_name == "level"}}},
                 {"encoding", std::move(encoding)}});
}

}  // namespace raystudy
