#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <limits>
#include <span>

#include "harness/method/cost_model.h"
#include "methods/topdown/box_record.h"

namespace raystudy::topdown {

/// Some of up to four boxes, a bit each.
using FewSet = std::uint32_t;

/// The unions of all subsets of up to four boxes and their measures: enough to decide on every division of them. A box that is
/// not there is empty.
class FewBoxes {
 public:
  static constexpr std::uint32_t most = 4;

  FewBoxes(const BoxRecord* records, std::uint32_t n) {
    for (const FewSet set : {0U, 2U, 4U, 8U}) WideBox::empty().store(unions_[set]);
    const WideBox b0 = add(1, WideBox::of(records[0]));
    add(3, b0);
    if (n < 2) return;
    const WideBox b1 = add(2, WideBox::of(records[1]));
    const WideBox b01 = add(3, united(b0, b1));
    if (n < 3) return;
    const WideBox b2 = add(4, WideBox::of(records[2]));
    const WideBox b02 = add(5, united(b0, b2));
    const WideBox b12 = add(6, united(b1, b2));
    const WideBox b012 = add(7, united(b01, b2));
    if (n < 4) return;
    const WideBox b3 = add(8, WideBox::of(records[3]));
    add(9, united(b0, b3));
    add(10, united(b1, b3));
    add(11, united(b01, b3));
    add(12, united(b2, b3));
    add(13, united(b02, b3));
    add(14, united(b12, b3));
    add(15, united(b012, b3));
  }

  [[nodiscard]] const BoxRecord& of(FewSet set) const { return unions_[set]; }

  /// Measures the unions of subsets of the first `n` boxes, for `measure` and `weight`.
  void evaluate(const SurfaceArea&, std::uint32_t n) {
    const auto box = [&](FewSet set) { return WideBox::of(unions_[set]); };
    for (FewSet set = 0; set < (1U << n); set += 4) {
      hn::Store(half_areas(box(set), box(set + 1), box(set + 2), box(set + 3)), Float4(), &measures_[set]);
    }
    weigh();
  }
  void evaluate(const Measure& measure, std::uint32_t n) {
    std::array<Box, 16> boxes;
    for (FewSet set = 1; set < (1U << n); ++set) boxes[set] = WideBox::of(unions_[set]).box();
    measure.evaluate(std::span(boxes).first(1U << n), std::span(measures_).first(1U << n));
    weigh();
  }
  [[nodiscard]] float measure(FewSet set) const { return measures_[set]; }
  /// m(set) · |set|, the cost of the set as one side of a division; infinite for the empty set.
  [[nodiscard]] float weight(FewSet set) const { return weights_[set]; }

 private:
  WideBox add(FewSet set, const WideBox& box) {
    box.store(unions_[set]);
    return box;
  }

  void weigh() {
    alignas(16) static constexpr float counts[16] = {0, 1, 1, 2, 1, 2, 2, 3, 1, 2, 2, 3, 2, 3, 3, 4};
    const Float4 d;
    for (FewSet set = 0; set < 16; set += 4) {
      hn::Store(hn::Mul(hn::Load(d, &measures_[set]), hn::Load(d, counts + set)), d, &weights_[set]);
    }
    weights_[0] = std::numeric_limits<float>::infinity();
  }

  std::array<BoxRecord, 16> unions_;
  alignas(16) std::array<float, 16> measures_{};
  alignas(16) std::array<float, 16> weights_;
};

}  // namespace raystudy::topdown
