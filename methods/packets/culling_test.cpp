// The parts of the kernels, for the instruction set that this file is compiled for.
#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "methods/packets/culling-inl.h"
#include "methods/wide/node_write.h"
#include "tests/support/rays.h"

HWY_BEFORE_NAMESPACE();
namespace raystudy::packets::HWY_NAMESPACE {
namespace {

using D = FloatsOf<4>;
constexpr std::size_t lanes = lanes_of<D>;

unsigned octant_of(Vec3 v) {
  return static_cast<unsigned>(std::signbit(v.x)) | (static_cast<unsigned>(std::signbit(v.y)) << 1U) |
         (static_cast<unsigned>(std::signbit(v.z)) << 2U);
}

/// A packet of one group.
struct OneGroup {
  RayGroup<D> group;
  SlabRanges<D> ranges;
  wide::SlabScene scene;
  NearPlanes sides;
  unsigned octant;
  D d;

  OneGroup(const std::array<Ray, lanes>& rays, const Box& bounds)
      : ranges(D(), octant_of(rays[0].direction)),
        scene(bounds),
        sides(octant_of(rays[0].direction)),
        octant(octant_of(rays[0].direction)) {
    make_ready(d, rays.data(), scene, group, ranges);
  }
  unsigned intervals(const WideNode<8>& node, float near, float far, std::array<float, 8>& enter) const {
    HWY_ALIGN std::array<float, 8> aligned;
    const unsigned met = cull_by_intervals(node, PacketSlabs(d, ranges), sides, near, far, aligned.data());
    enter = aligned;
    return met;
  }
  unsigned frustum(const WideNode<8>& node, float near, float far, std::array<float, 8>& enter) const {
    HWY_ALIGN std::array<float, 8> aligned;
    const PacketFrustum around(d, std::span<const RayGroup<D>>(&group, 1), octant, scene);
    if (around.along == 3) return intervals(node, near, far, enter);
    const unsigned met = cull_by_frustum(node, around, PacketSlabs(d, ranges), sides, near, far, aligned.data());
    enter = aligned;
    return met;
  }
};

/// Directions (1, y, y) for y from `low` to `high`, times `sign`.
std::array<Ray, lanes> fan(float low, float high, float sign) {
  std::array<Ray, lanes> rays;
  for (std::size_t i = 0; i < lanes; ++i) {
    const float y = low + (high - low) * static_cast<float>(i) / (lanes - 1);
    rays[i].direction = Vec3{1, y, y} * sign;
  }
  return rays;
}

Box box(Vec3 lower, Vec3 upper, float sign) {
  Box b;
  b.extend(lower * sign);
  b.extend(upper * sign);
  return b;
}

TEST(PacketCulling, BoxesByHand) {
  // Between x = 10 and 11, rays of slopes 0.1 to 0.3 are between 1 and 3.3 from the axis.
  for (const float sign : {1.0F, -1.0F}) {
    const std::vector<Box> boxes{
        box({10, 2, 2}, {11, 2.1F, 2.1F}, sign),    // among them
        box({10, 3.4F, 2}, {11, 4, 3}, sign),       // above
        box({10, 0, 0}, {11, 0.9F, 0.9F}, sign),    // below
        box({-11, -2, -2}, {-10, -1, -1}, sign),    // behind
        box({10, 3.25F, 3.25F}, {11, 9, 9}, sign),  // just touched by the steepest
        box({30, 4, 4}, {31, 5, 5}, sign),          // too far, were it not for t
    };
    WideNode<8> node;
    node.child.fill(WideChild::none);
    wide::set_boxes(node, boxes);
    Box bounds;
    for (const Box& b : boxes) bounds.extend(b);
    const OneGroup packet(fan(0.1F, 0.3F, sign), bounds);
    std::array<float, 8> enter{};
    EXPECT_EQ(packet.intervals(node, 0, 100, enter), 0b110001U);
    EXPECT_NEAR(enter[0], 10, 1e-3);
    EXPECT_NEAR(enter[4], 3.25 / 0.3, 1e-3);
    EXPECT_EQ(packet.intervals(node, 0, 29, enter), 0b010001U);
    EXPECT_EQ(packet.intervals(node, 12, 29, enter), 0U);
    EXPECT_EQ(packet.frustum(node, 0, 100, enter), 0b110001U);
    EXPECT_NEAR(enter[0], 10, 1e-3);
    EXPECT_NEAR(enter[4], 10, 1e-3);  // along the rays' axis alone
    EXPECT_EQ(packet.frustum(node, 0, 29, enter), 0b010001U);
    EXPECT_EQ(packet.frustum(node, 12, 29, enter), 0U);
  }
}

TEST(PacketCulling, NeverLosesABoxThatARayMeets) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> place(-1, 1);
  const auto point = [&] { return Vec3{place(random), place(random), place(random)}; };
  const Box bounds{{-2, -2, -2}, {2, 2, 2}};
  std::size_t met_boxes = 0;
  std::size_t met_by_narrow = 0;
  std::size_t kept_by_narrow = 0;
  for (int trial = 0; trial < 4000; ++trial) {
    std::array<Ray, lanes> rays;
    const Vec3 eye = 3 * point();
    const Vec3 direction = point() - eye;
    const float spread = trial % 3 == 0 ? 0.5F : 0.01F;
    for (Ray& ray : rays) {
      ray.origin = eye + (trial % 2 == 0 ? 0 : spread) * point();
      ray.direction = direction + spread * point();
      for (int a = 0; a < 3; ++a) ray.direction[a] = std::copysign(ray.direction[a], direction[a]);
      if (trial % 5 == 0) ray.direction[trial % 3] = std::copysign(0.0F, direction[trial % 3]);
      ray.tmax = 10;
    }
    std::vector<Box> boxes(8);
    for (Box& b : boxes) {
      const Vec3 p = point();
      b.extend(p);
      b.extend(p + (trial % 7 == 0 ? 0.0F : 0.8F) * point());
    }
    WideNode<8> node;
    wide::set_boxes(node, boxes);
    QuantizedNode<8> quantized;
    wide::set_boxes(quantized, boxes);
    OneGroup packet(rays, bounds);
    std::array<float, 8> by_intervals{};
    std::array<float, 8> by_frustum{};
    const unsigned intervals = packet.intervals(node, 0, 10, by_intervals);
    const unsigned frustum = packet.frustum(node, 0, 10, by_frustum);
    HWY_ALIGN std::array<float, 8> entered;
    const unsigned small =
        cull_by_intervals(quantized, PacketSlabs(packet.d, packet.ranges), packet.sides, 0, 10, entered.data());
    for (std::size_t i = 0; i < 8; ++i) {
      hn::Vec<D> enter;
      const auto met = meets(packet.d, packet.group, child_box(node, i), packet.sides, enter);
      if (spread < 0.1F) kept_by_narrow += (intervals >> i) & 1U;
      if (hn::AllFalse(packet.d, met)) continue;
      ++met_boxes;
      if (spread < 0.1F) ++met_by_narrow;
      ASSERT_TRUE(((intervals >> i) & 1U) != 0) << "trial " << trial;
      ASSERT_TRUE(((frustum >> i) & 1U) != 0) << "trial " << trial;
      ASSERT_TRUE(((small >> i) & 1U) != 0) << "trial " << trial;
      const float first = hn::GetLane(
          hn::MinOfLanes(packet.d, hn::IfThenElse(met, enter, hn::Set(packet.d, std::numeric_limits<float>::infinity()))));
      ASSERT_LE(by_intervals[i], first * 1.00001F + 1e-5F);
      ASSERT_LE(by_frustum[i], first * 1.00001F + 1e-5F);
    }
  }
  EXPECT_GT(met_boxes, 1000U);
  EXPECT_LT(kept_by_narrow, 2 * met_by_narrow);  // it is of use
}

TEST(RayGroup, IsWideRayLaneByLane) {
  std::vector<Ray> rays = test::random_rays(2000, 3);
  const std::vector<Ray> invalid = test::invalid_rays();
  rays.insert(rays.end(), invalid.begin(), invalid.end());
  const Box bounds{{-1, -2, -3}, {3, 2, 1}};
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (i % 9 == 0) rays[i].direction = rays[i].direction * 0x1p-70F;
    if (i % 13 == 0) rays[i].origin.x = 0x1p81F;
    const wide::WideRay expected(rays[i], wide::SlabScene(bounds));
    std::array<Ray, lanes> same;
    same.fill(rays[i]);
    const OneGroup packet(same, bounds);
    const RayGroup<D>& group = packet.group;
    ASSERT_EQ(group.active, expected.valid ? 0xfU : 0U);
    for (std::size_t lane = 0; lane < lanes; ++lane) {
      if (!expected.valid) {
        ASSERT_GT(group.near[lane], group.far[lane]);
        continue;
      }
      for (std::size_t a = 0; a < 3; ++a) {
        ASSERT_EQ(group.reciprocal[a][lane], expected.reciprocal[a]);
        ASSERT_EQ(group.near_offset[a][lane], expected.near_offset[a]);
        ASSERT_EQ(group.far_offset[a][lane], expected.far_offset[a]);
        ASSERT_EQ(packet.sides.side[a], (expected.negative >> a) & 1U);
      }
      ASSERT_EQ(group.along[static_cast<std::size_t>(expected.along)], 0xfU);
      ASSERT_EQ(group.origin[static_cast<std::size_t>(expected.across)][lane], expected.origin[0]);
      ASSERT_EQ(group.shear_across[lane], expected.shear_across);
      ASSERT_EQ(group.shear_up[lane], expected.shear_up);
      ASSERT_EQ(group.direction_along[lane], expected.direction_along);
      ASSERT_EQ(group.scale[lane], expected.scale);
      ASSERT_EQ(group.near[lane], expected.scaled(rays[i].tmin));
      ASSERT_EQ(group.far[lane], expected.scaled(rays[i].tmax));
    }
  }
}

}  // namespace
}  // namespace raystudy::packets::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
