#include "harness/report/label_layout.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

namespace raystudy {
namespace {

struct Rectangle {
  double left = 0;
  double top = 0;
  double right = 0;
  double bottom = 0;
};

Rectangle around(PanelPoint p, double radius) { return {p.x - radius, p.y - radius, p.x + radius, p.y + radius}; }

double overlap(const Rectangle& a, const Rectangle& b) {
  const double width = std::min(a.right, b.right) - std::max(a.left, b.left);
  const double height = std::min(a.bottom, b.bottom) - std::max(a.top, b.top);
  return width > 0 && height > 0 ? width * height : 0;
}

/// The length of the segment within the rectangle, by clipping it against the four sides (Liang and Barsky).
double length_within(PanelPoint a, PanelPoint b, const Rectangle& r) {
  const double dx = b.x - a.x;
  const double dy = b.y - a.y;
  double first = 0;
  double last = 1;
  for (const auto& [step, room] : {std::pair{-dx, a.x - r.left}, {dx, r.right - a.x}, {-dy, a.y - r.top}, {dy, r.bottom - a.y}}) {
    if (step == 0 && room < 0) return 0;
    if (step < 0) first = std::max(first, room / step);
    if (step > 0) last = std::min(last, room / step);
  }
  return last > first ? (last - first) * std::hypot(dx, dy) : 0;
}

PanelPoint nearest_in(const Rectangle& r, PanelPoint p) {
  return {std::clamp(p.x, r.left, r.right), std::clamp(p.y, r.top, r.bottom)};
}

class Layout {
 public:
  Layout(const std::vector<LabelRequest>& labels, const std::vector<PanelPoint>& curve, const LabelStyle& style)
      : labels_(labels), curve_(curve), style_(style) {}

  PlacedLabel place(const LabelRequest& label) {
    const double width = text_width(label.text, style_.font_size);
    const double half_height = style_.font_size * 0.62;
    double least = std::numeric_limits<double>::infinity();
    Rectangle best;
    for (const double distance : distances) {
      for (int direction = 0; direction < directions; ++direction) {
        const Rectangle box = beside(label.point, distance, direction, width, half_height);
        const double cost = this->cost(label.point, box, distance, direction);
        if (cost >= least) continue;
        least = cost;
        best = box;
      }
    }
    taken_.push_back(best);
    PlacedLabel placed{{best.left, (best.top + best.bottom) / 2}, false, {}, {}};
    const PanelPoint end = nearest_in(best, label.point);
    const double gap = std::hypot(end.x - label.point.x, end.y - label.point.y);
    if (gap > style_.point_radius + longest_gap_without_line) {
      const double start = (style_.point_radius + 1) / gap;
      placed.has_line = true;
      placed.from = {label.point.x + (end.x - label.point.x) * start, label.point.y + (end.y - label.point.y) * start};
      placed.to = end;
      lines_.emplace_back(placed.from, placed.to);
    }
    return placed;
  }

 private:
  static constexpr int directions = 16;
  static constexpr std::array<double, 8> distances{3, 7, 12, 20, 30, 42, 58, 78};
  static constexpr double longest_gap_without_line = 8;

  /// A box whose nearest part is `distance` from the point's edge, in one of the directions from the right anticlockwise.
  [[nodiscard]] Rectangle beside(PanelPoint p, double distance, int direction, double width, double half_height) const {
    const double angle = 2 * std::numbers::pi * direction / directions;
    const double reach = style_.point_radius + distance;
    const double x = std::cos(angle);
    const double y = -std::sin(angle);
    const PanelPoint center{p.x + x * (reach + width / 2), p.y + y * (reach + half_height)};
    return {center.x - width / 2, center.y - half_height, center.x + width / 2, center.y + half_height};
  }

  [[nodiscard]] double cost(PanelPoint own, const Rectangle& box, double distance, int direction) const {
    const Rectangle panel{2, 2, style_.width - 2, style_.height - 2};
    double sum = distance * 1.5 + (direction == 0 ? 0 : 1);
    sum += 20 * ((box.right - box.left) * (box.bottom - box.top) - overlap(box, panel));
    const Rectangle padded{box.left - 3, box.top - 1, box.right + 3, box.bottom + 1};
    for (const Rectangle& other : taken_) sum += 20 * overlap(padded, other);
    for (const LabelRequest& other : labels_) sum += 20 * overlap(padded, around(other.point, style_.point_radius));
    for (std::size_t i = 1; i < curve_.size(); ++i) sum += 3 * length_within(curve_[i - 1], curve_[i], padded);
    for (const auto& [from, to] : lines_) sum += 4 * length_within(from, to, padded);
    return sum + crossings(own, box);
  }

  /// What the line that would lead to the box runs over.
  [[nodiscard]] double crossings(PanelPoint own, const Rectangle& box) const {
    const PanelPoint end = nearest_in(box, own);
    double sum = 0;
    for (const Rectangle& other : taken_) sum += 4 * length_within(own, end, other);
    for (const LabelRequest& other : labels_) {
      if (other.point.x == own.x && other.point.y == own.y) continue;
      sum += 4 * length_within(own, end, around(other.point, style_.point_radius));
    }
    return sum;
  }

  const std::vector<LabelRequest>& labels_;
  const std::vector<PanelPoint>& curve_;
  const LabelStyle& style_;
  std::vector<Rectangle> taken_;
  std::vector<std::pair<PanelPoint, PanelPoint>> lines_;
};

}  // namespace

double text_width(const std::string& text, double font_size) {
  double ems = 0;
  for (const char c : text) {
    if ((static_cast<unsigned char>(c) & 0xC0U) == 0x80U) continue;  // the rest of a letter of several bytes
    const std::string_view narrow = "fijltr-.,:;'|!()[] I";
    const std::string_view wide = "mwMW%@";
    ems += narrow.find(c) != std::string_view::npos ? 0.39 : wide.find(c) != std::string_view::npos ? 0.95 : 0.625;
  }
  return ems * font_size;
}

std::vector<PlacedLabel> place_labels(const std::vector<LabelRequest>& labels, const std::vector<PanelPoint>& curve,
                                      const LabelStyle& style) {
  Layout layout(labels, curve, style);
  std::vector<PlacedLabel> placed;
  placed.reserve(labels.size());
  for (const LabelRequest& label : labels) placed.push_back(layout.place(label));
  return placed;
}

}  // namespace raystudy
