#include "harness/accel/tree_check.h"

#include "harness/accel/coverage.h"

namespace raystudy {

void TreeCheck::finish_leaves() {
  for (std::size_t t = 0; t < uses_.size() && !is_full(); ++t) {
    if (uses_[t] == 0 || (uses_[t] > 1 && !duplicates_)) report("triangle {} is in {} leaves", t, uses_[t]);
  }
  if (problems_.empty()) check_coverage();
}

/// Sorts the leaves' boxes by triangle, and asks of each triangle whether they cover it.
void TreeCheck::check_coverage() {
  std::vector<std::size_t> ends(uses_.size());
  std::size_t sum = 0;
  for (std::size_t t = 0; t < uses_.size(); ++t) {
    ends[t] = sum;
    sum += uses_[t];
  }
  std::vector<Box> boxes(parts_.size());
  for (const Part& part : parts_) boxes[ends[part.triangle]++] = part.box;
  for (std::size_t t = 0; t < uses_.size() && !parts_.empty(); ++t) {
    const Triangle& v = scene_->triangles[t];
    const std::span<const Box> around(boxes.data() + ends[t] - uses_[t], uses_[t]);
    if (boxes_cover(around, {scene_->vertices[v[0]], scene_->vertices[v[1]], scene_->vertices[v[2]]})) continue;
    report("triangle {} is not covered by the boxes of the {} leaves that it is in", t, uses_[t]);
  }
}

}  // namespace raystudy
