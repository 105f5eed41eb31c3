#include "methods/topdown/few_boxes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

namespace raystudy::topdown {
namespace {

/// Half the surface area by the path of any measure.
class HalfArea final : public Measure {
 public:
  void evaluate(std::span<const Box> boxes, std::span<float> out) const override {
    for (std::size_t i = 0; i < boxes.size(); ++i) out[i] = boxes[i].half_area();
  }
};

// Boxes 1 x 1 x 1 at x = 0, 1, 3 and 7. United over a length l of x they measure 1 + 2 l.
std::vector<BoxRecord> cubes() {
  std::vector<BoxRecord> records;
  for (const float x : {0.0F, 1.0F, 3.0F, 7.0F}) {
    records.push_back(BoxRecord::of({{x, 0, 0}, {x + 1, 1, 1}}, static_cast<std::uint32_t>(records.size()) + 10));
  }
  return records;
}

void expect_measures(const FewBoxes& boxes) {
  EXPECT_EQ(boxes.measure(0b0001), 3);
  EXPECT_EQ(boxes.measure(0b0011), 5);
  EXPECT_EQ(boxes.measure(0b0101), 9);
  EXPECT_EQ(boxes.measure(0b0110), 7);
  EXPECT_EQ(boxes.measure(0b0111), 9);
  EXPECT_EQ(boxes.weight(0b0001), 3);
  EXPECT_EQ(boxes.weight(0b0110), 14);
  EXPECT_EQ(boxes.weight(0b0111), 27);
  EXPECT_EQ(boxes.weight(0), std::numeric_limits<float>::infinity());
}

TEST(FewBoxes, MeasuresEverySubset) {
  const auto records = cubes();
  for (const std::uint32_t n : {3U, 4U}) {
    FewBoxes boxes(records.data(), n);
    boxes.evaluate(SurfaceArea(), n);
    expect_measures(boxes);
    boxes.evaluate(HalfArea(), n);
    expect_measures(boxes);
    if (n < 4) continue;
    EXPECT_EQ(boxes.measure(0b1000), 3);
    EXPECT_EQ(boxes.measure(0b1001), 17);
    EXPECT_EQ(boxes.measure(0b1100), 11);
    EXPECT_EQ(boxes.weight(0b1110), 3 * 15);
    EXPECT_EQ(boxes.weight(0b1111), 4 * 17);
  }
}

TEST(FewBoxes, KnowsTheBoxOfEverySubsetAndTheTriangleOfEveryBox) {
  const auto records = cubes();
  const FewBoxes boxes(records.data(), 4);
  for (FewSet set = 1; set < 16; ++set) {
    Box box;
    for (std::uint32_t i = 0; i < 4; ++i) {
      if ((set >> i & 1U) != 0) box.extend(WideBox::of(records[i]).box());
    }
    EXPECT_EQ(WideBox::of(boxes.of(set)).box(), box) << set;
  }
  EXPECT_EQ(boxes.of(0b0100).triangle, 12U);
}

TEST(BoxRecord, HoldsNoNegativeZero) {
  const BoxRecord r = BoxRecord::of({{-0.0F, 0, -1}, {-0.0F, 0, 1}}, 0);
  EXPECT_FALSE(std::signbit(r.lower[0]));
  const Vec3 upper = WideBox::of(r).box().upper;
  EXPECT_FALSE(std::signbit(upper.x));
  EXPECT_FALSE(std::signbit(upper.y));
}

}  // namespace
}  // namespace raystudy::topdown
