// The heuristic that CONTRIBUTING.md walks through: for rays that all go one way, say towards the sun, the chance that a ray
// meets a box is the box's area projected along that direction, not its surface area.
#include <cmath>

#include "harness/base/error.h"
#include "harness/method/registry.h"

namespace raystudy {
namespace {

/// m(box) = |d_x| e_y e_z + |d_y| e_z e_x + |d_z| e_x e_y for extents e and unit direction d.
class ProjectedAreaMeasure final : public Measure {
 public:
  explicit ProjectedAreaMeasure(Vec3 direction) : weight_{std::abs(direction.x), std::abs(direction.y), std::abs(direction.z)} {}

  void evaluate(std::span<const Box> boxes, std::span<float> out) const override {
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      const Vec3 e = boxes[i].is_empty() ? Vec3{} : boxes[i].extent();
      out[i] = dot(weight_, {e.y * e.z, e.z * e.x, e.x * e.y});
    }
  }

 private:
  Vec3 weight_;
};

class ProjectedArea final : public Heuristic {
 public:
  explicit ProjectedArea(const Params& params)
      : direction_{static_cast<float>(params.real("x")), static_cast<float>(params.real("y")),
                   static_cast<float>(params.real("z"))} {
    if (!(length(direction_) > 0)) throw Error("projected-area: the direction (x, y, z) is zero; expected any other");
  }

  static MethodInfo info() {
    return {
        .name = "projected-area",
        .summary = "area of a box projected along one direction: exact for parallel rays",
        .citation = "example of CONTRIBUTING.md; MacDonald and Booth 1990 for rays of one direction",
        .params = {real_param("x", 0, "x of the rays' direction", -1, 1), real_param("y", -1, "y of the rays' direction", -1, 1),
                   real_param("z", 0, "z of the rays' direction", -1, 1)}};
  }

  [[nodiscard]] std::shared_ptr<const Measure> prepare(const Scene&, const BuildContext&) const override {
    return std::make_shared<ProjectedAreaMeasure>(normalized(direction_));
  }

 private:
  Vec3 direction_;
};

const Registration<ProjectedArea> registration;

}  // namespace
}  // namespace raystudy
