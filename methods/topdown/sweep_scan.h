#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>

#include "harness/method/cost_model.h"
#include "methods/topdown/box_record.h"

namespace raystudy::topdown {

/// The boxes of a node's triangles in one order: records[list[0]], ..., records[list[n - 1]].
struct OrderedBoxes {
  const BoxRecord* records;
  const std::uint32_t* list;
  std::uint32_t n;

  [[nodiscard]] WideBox operator[](std::uint32_t i) const { return WideBox::of(records[list[i]]); }
  /// For groups of four that reach past the end: what is repeated does not change a union.
  [[nodiscard]] WideBox clamped(std::uint32_t i) const { return (*this)[std::min(i, n - 1)]; }
};

/// Slots that a buffer of measures needs before its first and after its last, since whole groups of four are written and read.
inline constexpr std::size_t measures_slack = 4;

/// measures[i] = m(union of boxes i to n - 1); returns the union of all.
inline WideBox suffix_measures(const SurfaceArea&, const OrderedBoxes& boxes, float* measures) {
  const Float4 d;
  WideBox acc = WideBox::empty();
  std::uint32_t end = boxes.n;
  for (; end >= 4; end -= 4) {
    hn::StoreU(grow<true>(acc, boxes[end - 1], boxes[end - 2], boxes[end - 3], boxes[end - 4]), d, measures + end - 4);
  }
  if (end > 0) {  // stores into the slack before
    const auto m = grow<true>(acc, boxes[end - 1], boxes[end > 1 ? end - 2 : 0], boxes[end > 2 ? end - 3 : 0], boxes[0]);
    hn::StoreU(m, d, measures + end - 4);
  }
  return acc;
}

/// Replaces measures[i], 0 < i < n, as suffix_measures left them, by the cost of the split into the first i boxes and the rest,
/// m(left) · i + m(right) · (n - i), and returns the least.
inline float split_costs(const SurfaceArea&, const OrderedBoxes& boxes, float* measures) {
  const Float4 d;
  const Int4 di;
  const auto infinity = hn::Set(d, std::numeric_limits<float>::infinity());
  auto left = hn::Iota(di, 1);  // boxes left of the four splits
  auto right = hn::Sub(hn::Set(di, static_cast<std::int32_t>(boxes.n)), left);
  auto least = infinity;
  WideBox acc = WideBox::empty();
  const auto costs = [&](std::uint32_t i, const WideBox& b0, const WideBox& b1, const WideBox& b2, const WideBox& b3) {
    const auto left_cost = hn::Mul(grow<false>(acc, b0, b1, b2, b3), hn::ConvertTo(d, left));
    const auto right_cost = hn::Mul(hn::LoadU(d, measures + i + 1), hn::ConvertTo(d, right));
    return hn::Add(left_cost, right_cost);
  };
  std::uint32_t i = 0;
  for (; i + 4 < boxes.n; i += 4) {
    const auto cost = costs(i, boxes[i], boxes[i + 1], boxes[i + 2], boxes[i + 3]);
    hn::StoreU(cost, d, measures + i + 1);
    least = hn::Min(cost, least);  // in this order minps drops a cost that is not a number
    left = hn::Add(left, hn::Set(di, 4));
    right = hn::Sub(right, hn::Set(di, 4));
  }
  const auto last = costs(i, boxes[i], boxes.clamped(i + 1), boxes.clamped(i + 2), boxes.clamped(i + 3));
  const auto valid = hn::IfThenElse(hn::RebindMask(d, hn::Gt(right, hn::Zero(di))), last, infinity);
  hn::StoreU(valid, d, measures + i + 1);  // into the slack after
  return hn::GetLane(hn::MinOfLanes(d, hn::Min(valid, least)));
}

/// suffix_measures, split_costs and most_balanced in one for 3 or 4 boxes, nine inner nodes of ten being small: nothing leaves
/// the registers. `all` becomes the union of all boxes, `left` the size of the left part of the best split.
inline float best_of_few(const SurfaceArea&, const OrderedBoxes& boxes, WideBox& all, std::uint32_t& left) {
  const Float4 d;
  const WideBox b0 = boxes[0];
  const WideBox b1 = boxes[1];
  const WideBox b2 = boxes[2];
  const WideBox b3 = boxes.clamped(3);
  WideBox from_right = WideBox::empty();
  WideBox from_left = WideBox::empty();
  const auto suffix = grow<true>(from_right, b3, b2, b1, b0);  // lane i: boxes i to n - 1
  const auto prefix = grow<false>(from_left, b0, b1, b2, b3);  // lane i: boxes 0 to i
  all = from_left;
  const bool four = boxes.n == 4;
  alignas(16) static constexpr float lefts[4] = {1, 2, 3, 0};
  alignas(16) static constexpr float rights[2][4] = {{2, 1, 0, 0}, {3, 2, 1, 0}};
  const auto right_measures = hn::ShiftRightLanes<1>(d, suffix);
  const auto cost = hn::Add(hn::Mul(prefix, hn::Load(d, lefts)), hn::Mul(right_measures, hn::Load(d, rights[four ? 1 : 0])));
  alignas(16) float c[4];
  hn::Store(cost, d, c);
  const float infinity = std::numeric_limits<float>::infinity();
  left = 0;
  float least = infinity;
  const auto consider = [&](std::uint32_t i) {  // in the order in which equal costs are preferred
    const bool less = c[i - 1] < least;
    least = less ? c[i - 1] : least;
    left = less ? i : left;
  };
  if (four) {
    consider(2);
    consider(1);
    consider(3);
  } else {
    consider(1);
    consider(2);
  }
  return least;
}

/// The same for any measure: boxes are gathered and measured a batch at a time.
class MeasureBatches {
 public:
  explicit MeasureBatches(const AnyMeasure& measure) : measure_(measure) {}

  template <class Take>
  void add(const Box& box, Take&& take) {
    boxes_[count_++] = box;
    if (count_ == size) flush(take);
  }
  /// Calls take(j, m) for the j-th box added since the last flush.
  template <class Take>
  void flush(Take&& take) {
    measure_.evaluate(std::span(boxes_).first(count_), std::span(values_).first(count_));
    for (std::uint32_t j = 0; j < count_; ++j) take(j, values_[j]);
    count_ = 0;
  }

 private:
  static constexpr std::uint32_t size = 256;
  AnyMeasure measure_;
  std::uint32_t count_ = 0;
  std::array<Box, size> boxes_;
  std::array<float, size> values_;
};

inline WideBox suffix_measures(const AnyMeasure& measure, const OrderedBoxes& boxes, float* measures) {
  MeasureBatches batches(measure);
  WideBox acc = WideBox::empty();
  std::uint32_t next = boxes.n;  // the first of a batch belongs to box next - 1
  std::uint32_t taken = 0;
  const auto take = [&](std::uint32_t j, float m) {
    measures[next - 1 - j] = m;
    ++taken;
  };
  for (std::uint32_t i = boxes.n; i-- > 0;) {
    acc = united(acc, boxes[i]);
    batches.add(acc.box(), take);
    next -= std::exchange(taken, 0);
  }
  batches.flush(take);
  return acc;
}

inline float split_costs(const AnyMeasure& measure, const OrderedBoxes& boxes, float* measures) {
  MeasureBatches batches(measure);
  WideBox acc = WideBox::empty();
  float least = std::numeric_limits<float>::infinity();
  std::uint32_t next = 1;
  std::uint32_t taken = 0;
  const auto take = [&](std::uint32_t j, float m) {
    const std::uint32_t left = next + j;
    float& cost = measures[left];
    cost = m * static_cast<float>(left) + cost * static_cast<float>(boxes.n - left);
    least = min(least, cost);
    ++taken;
  };
  for (std::uint32_t i = 0; i + 1 < boxes.n; ++i) {
    acc = united(acc, boxes[i]);
    batches.add(acc.box(), take);
    next += std::exchange(taken, 0);
  }
  batches.flush(take);
  return least;
}

/// The i in (0, n) with costs[i] == cost that is nearest to n / 2; of two as near, the smaller. Where the measure tells no two
/// splits apart (equal boxes, say), the tree must still get no deeper than it has to.
inline std::uint32_t most_balanced(const float* costs, std::uint32_t n, float cost) {
  std::uint32_t below = n / 2;
  std::uint32_t above = n - below;
  for (; below > 0; --below, ++above) {
    if (costs[below] == cost) return below;
    if (costs[above] == cost) return above;
  }
  return 0;  // there is none
}

}  // namespace raystudy::topdown
