#pragma once

#include <string>
#include <vector>

namespace raystudy {

/// A place in a plot's panel, in pixels; y grows downwards.
struct PanelPoint {
  double x = 0;
  double y = 0;
};

/// A text to be put beside a point.
struct LabelRequest {
  PanelPoint point;
  std::string text;
};

/// Where a text stands: its left end, halfway up. `from` and `to` are the ends of the line that leads to it from its point, where
/// it stands so far away that it needs one.
struct PlacedLabel {
  PanelPoint left;
  bool has_line = false;
  PanelPoint from;
  PanelPoint to;
};

struct LabelStyle {
  double width = 0;  ///< of the panel
  double height = 0;
  double font_size = 11;
  double point_radius = 6;
};

/// How wide the text is about, in DejaVu Sans of this size.
[[nodiscard]] double text_width(const std::string& text, double font_size);

/// Places labels, the first with the most choice, so that they overlap neither each other nor any point, stay within the panel,
/// avoid the polyline `curve`, and stand near their points: for each the best of a fan of places, one after the other.
[[nodiscard]] std::vector<PlacedLabel> place_labels(const std::vector<LabelRequest>& labels, const std::vector<PanelPoint>& curve,
                                                    const LabelStyle& style);

}  // namespace raystudy
