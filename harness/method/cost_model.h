#pragma once

#include <memory>
#include <span>

#include "harness/accel/bvh2.h"
#include "harness/accel/wide_bvh.h"
#include "harness/geometry/box.h"

namespace raystudy {

/// The expected number of rays that meet a box, up to a constant factor: what a Heuristic makes of a scene. Must not decrease
/// when a box grows.
class Measure {
 public:
  Measure() = default;
  Measure(const Measure&) = delete;
  Measure& operator=(const Measure&) = delete;
  virtual ~Measure() = default;

  /// out[i] = m(boxes[i]); the empty box measures 0. Called per batch; may be called from several threads at once.
  virtual void evaluate(std::span<const Box> boxes, std::span<float> out) const = 0;
};

/// The surface area heuristic's measure, m(N) = SA(N) / 2 (the factor cancels in every ratio).
class SurfaceArea final : public Measure {
 public:
  void evaluate(std::span<const Box> boxes, std::span<float> out) const override;
  float operator()(const Box& box) const { return box.half_area(); }
};

/// Any other measure in the form inner loops take as a template argument.
class AnyMeasure {
 public:
  explicit AnyMeasure(const Measure& measure) : measure_(&measure) {}
  float operator()(const Box& box) const {
    float value = 0;
    measure_->evaluate({&box, 1}, {&value, 1});
    return value;
  }
  void evaluate(std::span<const Box> boxes, std::span<float> out) const { measure_->evaluate(boxes, out); }

 private:
  const Measure* measure_;
};

/// Calls `f` with `measure` as a SurfaceArea (inlined) or as an AnyMeasure (one virtual call per evaluate).
template <class F>
decltype(auto) visit_measure(const Measure& measure, F&& f) {
  if (const auto* area = dynamic_cast<const SurfaceArea*>(&measure)) return f(*area);
  return f(AnyMeasure(measure));
}

[[nodiscard]] std::shared_ptr<const Measure> surface_area();

/// C = [ c_T Σ_inner m(N) + c_I Σ_leaf m(N) · t_N ] / m(root): Bittner 2015, Eq. 1, with m in place of SA.
struct CostModel {
  float traversal = 3;     ///< c_T: the cost of an inner node, with its children's box tests
  float intersection = 2;  ///< c_I: the cost of a ray-triangle test
  std::shared_ptr<const Measure> measure = surface_area();
};

/// The cost of a whole tree under `model`, summed in double depth first, wherever nodes lie; 0 for an empty tree. A root of
/// measure 0 (all triangles in one point) gives the cost of a ray that meets every box: c_T · inner nodes + c_I · triangles.
[[nodiscard]] double tree_cost(const Bvh2& bvh, const CostModel& model);
/// The same of a wide tree, in which an inner node's box is that of the slot which refers to it.
[[nodiscard]] double tree_cost(const WideBvh& bvh, const CostModel& model);

}  // namespace raystudy
