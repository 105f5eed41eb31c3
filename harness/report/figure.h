#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "harness/report/report.h"
#include "harness/spec/plan.h"

namespace raystudy {

/// The colour and the dash of a method's curve.
struct CurveStyle {
  std::string color;      ///< CSS
  std::vector<int> dash;  ///< lengths of dashes and gaps in pixels; empty: solid
};
/// What FigureSpec::styles says of the method ("red dashed"), else the next of a palette that colour-blind readers can tell
/// apart. Throws Error naming the figure's place for a style that is neither.
[[nodiscard]] CurveStyle curve_style(const FigureSpec& figure, std::size_t method);

/// The Vega-Lite specification of a figure of kind `depth-histogram`, `pareto` or `line`, as JSON text, data included. What it
/// cannot show is added to `gaps`. Empty where nothing at all can be drawn.
[[nodiscard]] std::string figure_spec(const FigureSpec& figure, const Report& report, std::vector<std::string>& gaps);

/// What became of a figure: the files that were written, and what is not in them and why.
struct FigureOutcome {
  std::string name;
  std::vector<std::filesystem::path> files;
  std::vector<std::string> gaps;
  std::vector<std::string> remarks;  ///< e.g. the mean steps per ray of a heat map
  bool failed = false;               ///< a picture that should be there is not
};

/// Draws the figure `name`, or all, into `folder` (made where it is missing): of plots NAME.vl.json, NAME.svg and NAME.png; of
/// pictures PNG, and heat maps also EXR with the steps themselves. A figure that cannot be drawn does not keep the others from
/// being drawn: its outcome says why. Throws Error for an unknown name, with the nearest, and where the folder cannot be written.
[[nodiscard]] std::vector<FigureOutcome> write_figures(const Report& report, const std::filesystem::path& folder,
                                                       const std::string& name = {});

/// `figure NAME: FILES`, then gaps and remarks, one a line.
[[nodiscard]] std::string outcome_text(const FigureOutcome& outcome);

/// Heat maps and shaded pictures: opens the scenes, builds the trees of the plan's pipelines and traces its workloads, in this
/// process.
void draw_pictures(const FigureSpec& figure, const Plan& plan, const std::filesystem::path& folder, FigureOutcome& outcome);

}  // namespace raystudy
