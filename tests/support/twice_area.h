#pragma once

#include <cstddef>
#include <memory>
#include <span>

#include "harness/method/registry.h"

namespace raystudy::test {

/// Twice the surface area: every comparison comes out as with the surface area, but through the path of any measure.
class TwiceArea final : public Measure {
 public:
  void evaluate(std::span<const Box> boxes, std::span<float> out) const override {
    for (std::size_t i = 0; i < boxes.size(); ++i) out[i] = 2 * boxes[i].half_area();
  }
};

/// The heuristic "test-twice-area" of every test that includes this.
class TwiceAreaHeuristic final : public Heuristic {
 public:
  explicit TwiceAreaHeuristic(const Params&) {}
  static MethodInfo info() { return {.name = "test-twice-area", .summary = "for tests", .citation = "none"}; }
  [[nodiscard]] std::shared_ptr<const Measure> prepare(const Scene&, const BuildContext&) const override {
    return std::make_shared<TwiceArea>();
  }
};
inline const Registration<TwiceAreaHeuristic> twice_area_registration;

}  // namespace raystudy::test
