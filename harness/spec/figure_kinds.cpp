#include "harness/spec/figure_kinds.h"

namespace raystudy {

const std::vector<FigureKind>& figure_kinds() {
  static const std::vector<FigureKind> all{
      {"heat-map",
       "traversal steps per ray of every pixel, from blue through red, with a legend; a picture for each scene and method",
       true,
       true,
       true,
       false,
       {real_param("lowest", 0, "steps shown in the first colour", 0, 1e6),
        real_param("highest", 100, "steps shown in the last colour, and above it", 0, 1e6)}},
      {"render", "a shaded picture of each scene, at the size of its workload", true, false, false, false, {}},
      {"film-strip",
       "frames of the animation side by side, triangles in the colours of a cut through the tree; a strip for each scene and "
       "method",
       false,
       true,
       false,
       false,
       {integer_param("frames", 5, "pictures, at equally spaced times", 2, 100),
        integer_param("triangles", 5000, "the cut: the topmost nodes of less than so many triangles", 1, 1e9),
        integer_param("width", 480, "of a picture, in pixels", 16, 16384), integer_param("height", 320, "in pixels", 16, 16384),
        text_param("camera", "", "the scene's first where none is named")}},
      {"depth-histogram",
       "sums of node surface areas at each depth, inner nodes on the left and leaves on the right; a curve for each method",
       false,
       true,
       true,
       false,
       {}},
      {"pareto",
       "build time against the time to trace a ray, both axes logarithmic: a point for each method, the Pareto front through "
       "those that no "
       "other beats in both; a panel for each scene and workload",
       true,
       true,
       false,
       true,
       {}},
      {"line",
       "a quantity over another: a series over its own axis, or single numbers over the triangles of the scenes",
       false,
       true,
       true,
       false,
       {text_param("y", "cost_over_time", "the quantity"),
        choice_param("x", {"axis", "triangles"}, "the series' own axis, or the scenes' triangles"),
        boolean_param("log_x", false, "logarithmic horizontal axis"), boolean_param("log_y", false, "logarithmic vertical axis"),
        real_param("reference_exponent", 0,
                   "over triangles, both axes logarithmic: beside each curve a grey line of this power of the triangles; 0: none",
                   0, 10)}},
  };
  return all;
}

const FigureKind* find_figure_kind(std::string_view name) {
  for (const FigureKind& kind : figure_kinds()) {
    if (kind.name == name) return &kind;
  }
  return nullptr;
}

}  // namespace raystudy
