#include "scenes/procedural/stands.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "scenes/procedural/numeric.h"

namespace raystudy::procedural {
namespace {

enum : std::uint32_t { meadow, light_grass, dark_grass, track, line, concrete, seats, roof, steel, lamp };

constexpr Vec3 field{52.5F, 0, 34};  // half sizes of the pitch in metres

class Stands {
 public:
  Stands(Mesh& mesh, int around, int rows, int masts) : mesh_(mesh), around_(around), rows_(rows), masts_(masts) {}

  void build() {
    ground();
    terraces();
    for (int i = 0; i < masts_; ++i) mast((static_cast<double>(i) + 0.5) / masts_);
  }

 private:
  void flat(std::uint32_t material, float half_x, float half_z, float y) {
    mesh_.material(material);
    mesh_.quad({-half_x, y, half_z}, {half_x, y, half_z}, {half_x, y, -half_z}, {-half_x, y, -half_z});
  }

  void ring(std::uint32_t material, float inner, float outer, float inner_height, float outer_height) {
    mesh_.material(material);
    mesh_.grid(around_, 1, true,
               [&](float u, float v) { return oval(-u, mixed(inner, outer, v), mixed(inner_height, outer_height, v)); });
  }

  void ground() {
    flat(meadow, 260, 240, -0.06F);
    ring(track, -1.5F, 9, 0, 0);
    mesh_.material(meadow);
    mesh_.fan(around_, {0, -0.02F, 0}, [](float u) { return oval(-u, -1.5F, -0.02F); });
    constexpr int stripes = 10;
    for (int i = 0; i < stripes; ++i) {
      const float x0 = field.x * (2 * static_cast<float>(i) / stripes - 1);
      const float x1 = field.x * (2 * static_cast<float>(i + 1) / stripes - 1);
      mesh_.material(i % 2 == 0 ? light_grass : dark_grass);
      mesh_.quad({x0, 0, field.z}, {x1, 0, field.z}, {x1, 0, -field.z}, {x0, 0, -field.z});
    }
    mesh_.material(line);
    const auto mark = [&](float x, float z, float half_x, float half_z) {
      mesh_.quad({x - half_x, 0.01F, z + half_z}, {x + half_x, 0.01F, z + half_z}, {x + half_x, 0.01F, z - half_z},
                 {x - half_x, 0.01F, z - half_z});
    };
    for (const float sign : {-1.0F, 1.0F}) {
      mark(0, sign * field.z, field.x, 0.06F);
      mark(sign * field.x, 0, 0.06F, field.z);
      mark(sign * (field.x - 16.5F), 0, 0.06F, 20.16F);
      mark(sign * (field.x - 8.25F), 20.16F, 8.25F, 0.06F);
      mark(sign * (field.x - 8.25F), -20.16F, 8.25F, 0.06F);
    }
    mark(0, 0, 0.06F, field.z);
    mesh_.grid(std::min(64, around_), 1, true, [](float u, float v) {
      const float r = 9.15F + 0.12F * v;
      return Vec3{r * cos_turns(-u), 0.012F, r * sin_turns(-u)};
    });
    for (const float sign : {-1.0F, 1.0F}) goal(sign * field.x);
  }

  void goal(float x) {
    mesh_.box({}, {x - 0.06F, 0, -3.72F}, {x + 0.06F, 2.44F, -3.60F});
    mesh_.box({}, {x - 0.06F, 0, 3.60F}, {x + 0.06F, 2.44F, 3.72F});
    mesh_.box({}, {x - 0.06F, 2.44F, -3.72F}, {x + 0.06F, 2.56F, 3.72F});
  }

  void terraces() {
    constexpr float depth = 44;
    constexpr float height = 27;
    ring(concrete, 9, 9, 0, 2);
    for (int row = 0; row < rows_; ++row) {
      const float a = static_cast<float>(row) / static_cast<float>(rows_);
      const float b = static_cast<float>(row + 1) / static_cast<float>(rows_);
      // The rake steepens upwards.
      const auto rise = [](float t) { return 2 + (height - 2) * (0.75F * t + 0.25F * t * t); };
      ring(row % 3 == 2 ? concrete : seats, 9 + depth * a, 9 + depth * b, rise(a), rise(a));
      ring(concrete, 9 + depth * b, 9 + depth * b, rise(a), rise(b));
    }
    ring(concrete, 9 + depth, 9 + depth, height, 0);
    ring(roof, 9 + depth + 2, 9 + 0.45F * depth, height + 8, height + 11);
    const int pillars = around_ / 2;
    mesh_.material(steel);
    for (int i = 0; i < pillars; ++i) {
      const auto turn = static_cast<double>(i) / pillars;
      const Vec3 foot = oval(static_cast<float>(turn), 9 + depth + 1, 0);
      const Vec3 out{cos_turns(turn), 0, sin_turns(turn)};
      mesh_.box({foot, out, {0, 1, 0}, cross(out, {0, 1, 0})}, {-0.5F, 0, -0.4F}, {0.5F, height + 8, 0.4F});
    }
  }

  void mast(double turn) {
    const Vec3 foot = oval(static_cast<float>(turn), 64, 0);
    const Vec3 in = normalized(Vec3{0, 0, 0} - foot);
    const Frame frame{foot, in, {0, 1, 0}, cross(in, {0, 1, 0})};
    mesh_.material(steel);
    for (int leg = 0; leg < 4; ++leg) {
      const float x = leg % 2 == 0 ? -1.2F : 1.0F;
      const float z = leg < 2 ? -1.2F : 1.0F;
      mesh_.box(frame, {x, 0, z}, {x + 0.2F, 56, z + 0.2F});
    }
    mesh_.box(frame, {-0.6F, 54, -7}, {0.4F, 64, 7});
    mesh_.material(lamp);
    for (int k = 0; k < 8; ++k) {
      const float z = -6.2F + 1.6F * static_cast<float>(k);
      mesh_.box(frame, {0.4F, 55, z}, {0.6F, 58.6F, z + 1.2F});
      mesh_.box(frame, {0.4F, 59.6F, z}, {0.6F, 63.2F, z + 1.2F});
    }
  }

  Mesh& mesh_;
  int around_;
  int rows_;
  int masts_;
};

}  // namespace

Vec3 oval(float turns, float out, float height) {
  const float c = cos_turns(turns);
  const float s = sin_turns(turns);
  const float size = 1 / std::sqrt(std::sqrt(squared(squared(c / (62 + out))) + squared(squared(s / (43 + out)))));
  return {size * c, height, size * s};
}

void stands(Mesh& mesh, int around, int rows, int masts) { Stands(mesh, around, rows, masts).build(); }

std::vector<Material> stands_materials() {
  return {
      {.name = "meadow", .color = {0.20F, 0.25F, 0.11F}},
      {.name = "light-grass", .color = {0.15F, 0.28F, 0.08F}},
      {.name = "dark-grass", .color = {0.11F, 0.22F, 0.06F}},
      {.name = "track", .color = {0.42F, 0.15F, 0.09F}},
      {.name = "line", .color = {0.80F, 0.80F, 0.78F}},
      {.name = "concrete", .color = {0.46F, 0.45F, 0.43F}},
      {.name = "seats", .color = {0.12F, 0.19F, 0.34F}},
      {.name = "roof", .color = {0.66F, 0.67F, 0.68F}},
      {.name = "steel", .color = {0.42F, 0.44F, 0.46F}},
      {.name = "lamp", .kind = MaterialKind::emitter, .color = Vec3{1}, .emission = {3, 3, 2.7F}},
  };
}

}  // namespace raystudy::procedural
