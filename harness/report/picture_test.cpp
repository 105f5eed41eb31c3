#include "harness/report/picture.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <deque>
#include <stdexcept>

#include "harness/base/error.h"
#include "harness/method/registry.h"

namespace raystudy {
namespace {

using testing::ElementsAre;
using testing::FloatNear;

/// Says of the rays it is given, in order, the steps it was told.
class ToldSteps : public TraceSession {
 public:
  explicit ToldSteps(std::deque<std::uint32_t> steps) : steps_(std::move(steps)) {}
  void trace(std::span<const Ray>, std::span<Hit>, Query) override {}
  [[nodiscard]] bool counts() const override { return true; }
  TraceCounts count(std::span<const Ray> rays, Query, std::span<std::uint32_t> steps) override {
    for (std::size_t i = 0; i < rays.size(); ++i) {
      steps[i] = steps_.front();
      steps_.pop_front();
    }
    return {};
  }

 private:
  std::deque<std::uint32_t> steps_;
};

class CannotCount : public TraceSession {
 public:
  void trace(std::span<const Ray>, std::span<Hit>, Query) override {}
};

RayBatch batch_of(std::size_t rays, std::vector<std::uint32_t> pixels) {
  RayBatch batch;
  batch.rays.resize(rays);
  batch.width = 3;
  batch.height = 1;
  batch.ray_pixels = std::move(pixels);
  return batch;
}

TEST(CountSteps, AveragesOverAllRaysOfAPixel) {
  ToldSteps session({10, 20, 30, 4, 7, 6});
  const std::vector<RayBatch> batches{batch_of(3, {}), batch_of(3, {0, 2, 0})};
  const StepMap map = count_steps(session, batches);
  EXPECT_EQ(map.width, 3);
  EXPECT_EQ(map.height, 1);
  // Pixel 0: 10, 4 and 6; pixel 1: 20; pixel 2: 30 and 7.
  EXPECT_THAT(map.steps, ElementsAre(FloatNear(20.0F / 3, 1e-5F), 20.0F, 18.5F));
  EXPECT_DOUBLE_EQ(map.mean, 77.0 / 6);
  const Image raw = step_image(map);
  EXPECT_EQ(raw.kind, ImageKind::data);
  EXPECT_EQ(raw.pixels, map.steps);
}

TEST(CountSteps, RefusesATracerThatCannotCount) {
  CannotCount session;
  try {
    (void)count_steps(session, std::vector<RayBatch>{batch_of(1, {0})});
    FAIL();
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(), "this tracer cannot count traversal steps; expected a tracer that counts, such as 'scalar'");
  }
}

TEST(CountSteps, RefusesRaysWithoutPixels) {
  ToldSteps session({});
  EXPECT_THROW((void)count_steps(session, std::vector<RayBatch>(1)), std::logic_error);
  std::vector<RayBatch> different{batch_of(0, {}), batch_of(0, {})};
  different[1].width = 4;
  EXPECT_THROW((void)count_steps(session, different), std::logic_error);
}

TEST(HeatMap, RunsFromBlueToRed) {
  const Vec3 none = heat_color(0);
  const Vec3 most = heat_color(1);
  EXPECT_GT(none.z, 10 * none.x);
  EXPECT_GT(none.z, 10 * none.y);
  EXPECT_GT(most.x, 10 * most.y);
  EXPECT_GT(most.x, 10 * most.z);
  EXPECT_EQ(heat_color(7), most);
  EXPECT_EQ(heat_color(-7), none);
}

TEST(HeatMap, ScaleEndsAtItsMaximum) {
  const StepMap map{.width = 4, .height = 1, .steps = {0, 30, 60, 500}};
  const Image picture = heat_map(map, {.max_steps = 60, .legend = false});
  EXPECT_EQ(picture.height, 1);
  const auto color = [&](int x) { return Vec3{picture.at(x, 0)[0], picture.at(x, 0)[1], picture.at(x, 0)[2]}; };
  EXPECT_EQ(color(0), heat_color(0));
  EXPECT_EQ(color(1), heat_color(0.5F));
  EXPECT_EQ(color(2), heat_color(1));
  EXPECT_EQ(color(3), heat_color(1));
  EXPECT_THROW((void)heat_map(map, {.min_steps = 5, .max_steps = 5}), std::logic_error);
}

TEST(HeatMap, LegendStandsBelow) {
  StepMap map{.width = 400, .height = 10};
  map.steps.resize(4000);
  const Image picture = heat_map(map, {});
  EXPECT_EQ(picture.width, 400);
  EXPECT_EQ(picture.height, 10 + heat_legend(400, {}).height);
  EXPECT_EQ(picture.pixels.size(), std::size_t{3} * picture.width * picture.height);
}

class Shaded : public testing::Test {
 protected:
  Shaded() {
    scene_.name = "square";
    scene_.vertices = SharedArray<Vec3>({{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}});
    scene_.triangles = SharedArray<Triangle>({{{0, 1, 2}}, {{0, 2, 3}}});
    scene_.materials = {{.name = "paint", .color = {0.5F, 0.25F, 0}}};
    scene_.lights = {{.name = "sun", .position = {0, 3, 4}, .intensity = Vec3{2}, .point_at_infinity = true}};
    finish_scene(scene_, "test");
  }
  [[nodiscard]] Image render(const RenderOptions& options) const {
    const Registry& registry = Registry::instance();
    const auto accel = registry.create<Builder>({"sweep-sah", nullptr})->build(scene_, {});
    const auto session = registry.create<Tracer>({"scalar", nullptr})->prepare(*accel, scene_, 1, false);
    return render_shaded(scene_, {.name = "front", .eye = {0, 0, 5}, .target = {0, 0, 0}, .vertical_fov = 40}, *session, options);
  }
  Scene scene_;
};

TEST_F(Shaded, IsLambertsLawUnderALight) {
  const Image image = render({.width = 33, .height = 33, .samples = 1, .ambient_rays = 0});
  EXPECT_EQ(image.kind, ImageKind::radiance);
  // Cosine 4/5 of intensity 2, and at most a tenth and a bit from the eye's light and the rest light.
  const float* middle = image.at(16, 16);
  EXPECT_GT(middle[0], 0.5F * 1.6F);
  EXPECT_LT(middle[0], 0.5F * 1.75F);
  EXPECT_NEAR(middle[1], middle[0] / 2, 0.01F);
  EXPECT_EQ(middle[2], 0);
  EXPECT_GT(image.at(0, 0)[2], 0.3F);  // the sky
}

TEST_F(Shaded, TheLightsFarSideIsDark) {
  scene_.lights[0].position = {0, 3, -4};
  const Image image = render({.width = 9, .height = 9, .samples = 1, .ambient_rays = 0});
  EXPECT_LT(image.at(4, 4)[0], 0.1F);
}

TEST_F(Shaded, IsTheSameForASeedAndReportsItsProgress) {
  double last = 0;
  RenderOptions options{.width = 20, .height = 15, .samples = 4, .ambient_rays = 4};
  options.progress = [&last](double share) { last = share; };
  EXPECT_EQ(render(options).pixels, render(options).pixels);
  EXPECT_EQ(last, 1);
}

TEST_F(Shaded, AmbientLightReachesAnOpenSurface) {
  scene_.lights.clear();
  const float without = render({.width = 9, .height = 9, .samples = 1, .ambient_rays = 0}).at(4, 4)[0];
  const float with = render({.width = 9, .height = 9, .samples = 1, .ambient_rays = 8}).at(4, 4)[0];
  EXPECT_GT(with, without + 0.1F);
}

}  // namespace
}  // namespace raystudy
