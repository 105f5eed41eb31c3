#pragma once

// What the kinds of plot share: each is one file, plot_KIND.cpp, and gives a Vega-Lite specification.

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "harness/report/figure.h"

namespace raystudy {

using Json = nlohmann::ordered_json;

// One function a kind. Each is null where nothing can be drawn; what it cannot show is added to `gaps`.

[[nodiscard]] Json depth_histogram(const FigureSpec& figure, const Report& report, std::vector<std::string>& gaps);
/// A series over its own axis. A logarithmic axis has no place for 0: such points are left out, and that is said.
[[nodiscard]] Json series_plot(const FigureSpec& figure, const Report& report, std::vector<std::string>& gaps);
/// A single number over the triangles of the scenes: a curve for each method, a panel for each scene of a sweep.
[[nodiscard]] Json scaling_plot(const FigureSpec& figure, const Report& report, std::vector<std::string>& gaps);
/// Build time against time to trace a ray, a panel for each scene and workload.
[[nodiscard]] Json pareto_plot(const FigureSpec& figure, const Report& report, std::vector<std::string>& gaps);

/// A whole specification without its marks: fonts, colours, caption, and the data.
[[nodiscard]] Json document(const FigureSpec& figure, Json rows);
/// Panels beside each other, one a scene where there are several. `explained` stands below the caption.
[[nodiscard]] Json panels(const FigureSpec& figure, const std::vector<std::string>& scenes, Json rows, const Json& panel,
                          const std::string& explained = {});
/// Colour and dash by method, with one legend for both.
void add_styles(Json& encoding, const FigureSpec& figure);
/// A position channel. `logarithmic` names the figure's option.
[[nodiscard]] Json axis(const FigureSpec& figure, const std::string& field, const std::string& title,
                        const std::string& logarithmic, const std::string& format);
[[nodiscard]] bool is_logarithmic(const FigureSpec& figure, const std::string& option);
/// The option's text; empty where the figure has none.
[[nodiscard]] std::string option_of(const FigureSpec& figure, const std::string& name);

/// "time [s]"; a pure number has no unit.
[[nodiscard]] std::string with_unit(const std::string& text, const std::string& unit);
/// "cost_over_time" → "cost over time".
[[nodiscard]] std::string words(std::string name);

/// The build cell's result, or null with the reason among `gaps`.
[[nodiscard]] const CellResult* build_result(const Report& report, const std::string& scene, const std::string& method,
                                             std::vector<std::string>& gaps);
/// The result of the figure's tracer (each method's own, where the figure says so) and of `workload`, or null with the reason
/// among `gaps`.
[[nodiscard]] const CellResult* traced_result(const Report& report, const FigureSpec& figure, const std::string& scene,
                                              const std::string& method, const std::string& workload,
                                              std::vector<std::string>& gaps);
/// The result's series, or null with the reason among `gaps`.
[[nodiscard]] const Series* series_of(const CellResult& result, const std::string& name, std::vector<std::string>& gaps);

}  // namespace raystudy
