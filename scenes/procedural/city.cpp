#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "harness/scene/procedural.h"
#include "scenes/procedural/mesh.h"
#include "scenes/procedural/numeric.h"
#include "scenes/procedural/random.h"

namespace raystudy::procedural {
namespace {

enum : std::uint32_t { asphalt, pavement, concrete, brick, plaster, dark_metal, steel, glass, paint };

constexpr float lot = 46;     // metres from house to house
constexpr float street = 15;  // metres between the fronts
constexpr float storey = 3.4F;

/// Adds boxes until they are used up: everything in the city is boxes, and a house gets as many as its share.
class Boxes {
 public:
  Boxes(Mesh& mesh, std::int64_t count) : mesh_(mesh), left_(count) {}
  [[nodiscard]] std::int64_t left() const { return left_; }
  bool add(const Frame& frame, std::uint32_t material, Vec3 lower, Vec3 upper) {
    if (left_ <= 0) return false;
    --left_;
    mesh_.material(material);
    mesh_.box(frame, lower, upper);
    return true;
  }
  /// A rod of square section from a to b: a box whose long axis leans.
  bool rod(std::uint32_t material, Vec3 a, Vec3 b, float thickness) {
    const Vec3 along = normalized(b - a);
    const Vec3 side = normalized(cross(std::fabs(along.y) < 0.9F ? Vec3{0, 1, 0} : Vec3{1, 0, 0}, along));
    const float t = thickness / 2;
    return add({a, side, along, cross(side, along)}, material, {-t, 0, -t}, {t, length(b - a), t});
  }

 private:
  Mesh& mesh_;
  std::int64_t left_;
};

/// A part of a house: a box that stands at (x, z) in the house's frame, with half widths.
struct Volume {
  float x, z, half_x, half_z, bottom, top;
};

class House {
 public:
  House(Boxes& boxes, const Frame& frame, float height, float width, Random random)
      : boxes_(boxes), frame_(frame), random_(random), height_(height), width_(width) {}

  /// Coarse to fine: a house of few boxes is its bare volumes, one of many has every glazing bar.
  void build() {
    walls_ = concrete + static_cast<std::uint32_t>(random_.below(3));
    tower_ = height_ > 11 * storey;
    if (tower_) walls_ = random_.below(3) == 0 ? dark_metal : static_cast<std::uint32_t>(concrete);
    volumes();
    roof();
    if (tower_) windows();
    ledges();
    fins();
    if (!tower_) windows();
    bars();
  }

 private:
  [[nodiscard]] float base_top() const { return tower_ ? 2 * storey : 0; }

  void volumes() {
    const float w = width_ / 2;
    if (!tower_) {
      count_ = 1;
      volumes_[0] = {0, 0, w, w * random_.uniform(0.7F, 1), 0, height_};
      if (random_.below(2) == 0) {
        volumes_[count_++] = {w * 0.4F, w * 0.3F, w * 0.6F, w * 0.68F, 0, height_ * random_.uniform(0.5F, 0.8F)};
      }
    } else {
      count_ = 0;
      volumes_[count_++] = {0, 0, w, w, 0, base_top()};
      const int steps = 1 + random_.below(3);
      float bottom = base_top();
      float half = w * random_.uniform(0.66F, 0.85F);
      for (int i = 0; i < steps; ++i) {
        const float top = i + 1 == steps ? height_ : mixed(bottom, height_, random_.uniform(0.5F, 0.75F));
        const float slim = random_.uniform(0.75F, 1);
        volumes_[count_++] = {0, 0, half, half * slim, bottom, top};
        bottom = top;
        half *= random_.uniform(0.7F, 0.85F);
      }
    }
    for (std::size_t i = 0; i < count_; ++i) {
      const Volume& v = volumes_[i];
      boxes_.add(frame_, walls_, {v.x - v.half_x, v.bottom, v.z - v.half_z}, {v.x + v.half_x, v.top, v.z + v.half_z});
    }
  }

  void roof() {
    const Volume& v = volumes_[count_ - 1];
    const float y = v.top;
    if (tower_) {
      const Frame top = frame_.moved({v.x, y, v.z});
      boxes_.add(top, dark_metal, {-0.4F * v.half_x, 0, -0.5F * v.half_z}, {0.35F * v.half_x, storey, 0.3F * v.half_z});
      if (random_.below(2) == 0) {
        const float mast = height_ * random_.uniform(0.12F, 0.25F);
        boxes_.add(top, steel, {-0.18F, storey, -0.18F}, {0.18F, storey + mast, 0.18F});
        for (int i = 0; i < 3; ++i) {
          const auto turn = static_cast<double>(i) / 3;
          const Vec3 foot{0.9F * v.half_x * cos_turns(turn), 0, 0.9F * v.half_z * sin_turns(turn)};
          boxes_.rod(steel, top.at(foot), top.at({0, storey + mast * 0.85F, 0}), 0.07F);
        }
      }
    } else {
      for (int i = 0; i < 2; ++i) {
        const Frame top =
            frame_.moved({v.x + random_.uniform(-0.5F, 0.5F) * v.half_x, y, v.z + random_.uniform(-0.5F, 0.5F) * v.half_z});
        const float size = random_.uniform(0.6F, 1.6F);
        boxes_.add(top, i == 0 ? brick : static_cast<std::uint32_t>(steel), {-size, 0, -size * 0.6F},
                   {size, size * 1.4F, size * 0.6F});
      }
    }
    for (std::size_t i = 0; i < count_; ++i) parapet(volumes_[i]);
  }

  void parapet(const Volume& v) {
    const Frame top = frame_.moved({v.x, v.top, v.z});
    const float t = 0.3F;
    const float h = 0.9F;
    boxes_.add(top, walls_, {-v.half_x, 0, -v.half_z}, {v.half_x, h, -v.half_z + t});
    boxes_.add(top, walls_, {-v.half_x, 0, v.half_z - t}, {v.half_x, h, v.half_z});
    boxes_.add(top, walls_, {-v.half_x, 0, -v.half_z + t}, {-v.half_x + t, h, v.half_z - t});
    boxes_.add(top, walls_, {v.half_x - t, 0, -v.half_z + t}, {v.half_x, h, v.half_z - t});
  }

  /// Calls f(face frame, half width, bottom, top) for each façade; x runs along it, z away from the house.
  template <class F>
  void facades(F&& f) {
    for (std::size_t i = 0; i < count_; ++i) {
      const Volume& v = volumes_[i];
      const Frame middle = frame_.moved({v.x, 0, v.z});
      const Vec3 x = frame_.x;
      const Vec3 z = frame_.z;
      f(Frame{middle.at({0, 0, v.half_z}), x, frame_.y, z}, v.half_x, v.bottom, v.top);
      f(Frame{middle.at({v.half_x, 0, 0}), -z, frame_.y, x}, v.half_z, v.bottom, v.top);
      f(Frame{middle.at({0, 0, -v.half_z}), -x, frame_.y, -z}, v.half_x, v.bottom, v.top);
      f(Frame{middle.at({-v.half_x, 0, 0}), z, frame_.y, -x}, v.half_z, v.bottom, v.top);
    }
  }

  /// Thin slabs around the house at the floors; every fourth, then every floor.
  void ledges() {
    for (const int every : {4, 1}) {
      if (every == 1 && boxes_.left() < 60) return;
      for (std::size_t i = 0; i < count_; ++i) {
        const Volume& v = volumes_[i];
        const int floors = static_cast<int>((v.top - v.bottom) / storey);
        for (int k = 1; k < floors; ++k) {
          if ((every == 4) != (k % 4 == 0)) continue;
          const float y = v.bottom + static_cast<float>(k) * storey;
          const float out = every == 4 ? 0.35F : 0.2F;
          const float t = every == 4 ? 0.35F : 0.18F;
          boxes_.add(frame_, every == 4 ? static_cast<std::uint32_t>(steel) : walls_,
                     {v.x - v.half_x - out, y - t, v.z - v.half_z - out}, {v.x + v.half_x + out, y, v.z + v.half_z + out});
        }
      }
    }
  }

  /// Slender pillars from foot to roof: the long thin triangles of the scene.
  void fins() {
    const float gap = random_.uniform(3, 5);
    facades([&](const Frame& face, float half, float bottom, float top) {
      const int n = std::max(2, static_cast<int>(2 * half / gap));
      for (int i = 0; i <= n; ++i) {
        const float x = mixed(-half + 0.15F, half - 0.15F, static_cast<float>(i) / static_cast<float>(n));
        boxes_.add(face, tower_ ? static_cast<std::uint32_t>(steel) : walls_, {x - 0.14F, bottom, -0.1F},
                   {x + 0.14F, top, 0.30F});
      }
    });
  }

  template <class F>
  void panes(F&& f) {
    const float wide = pane_;
    facades([&](const Frame& face, float half, float bottom, float top) {
      const int floors = static_cast<int>((top - bottom) / storey);
      const int n = std::max(1, static_cast<int>(2 * half / wide));
      for (int k = 0; k < floors; ++k) {
        for (int i = 0; i < n && boxes_.left() > 0; ++i) {
          const float x0 = mixed(-half, half, static_cast<float>(i) / static_cast<float>(n));
          const float x1 = mixed(-half, half, static_cast<float>(i + 1) / static_cast<float>(n));
          const float y = bottom + static_cast<float>(k) * storey;
          f(face, mixed(x0, x1, 0.16F), mixed(x0, x1, 0.84F), y + 0.9F, y + storey - 0.55F);
        }
      }
    });
  }

  /// Towers have a ribbon of glass a floor, other houses single windows.
  void windows() {
    pane_ = random_.uniform(2.2F, 3.2F);
    if (!tower_) {
      panes([&](const Frame& face, float x0, float x1, float y0, float y1) {
        boxes_.add(face, glass, {x0, y0, -0.05F}, {x1, y1, 0.05F});
      });
      return;
    }
    facades([&](const Frame& face, float half, float bottom, float top) {
      const int floors = static_cast<int>((top - bottom) / storey);
      for (int k = 0; k < floors; ++k) {
        const float y = bottom + static_cast<float>(k) * storey;
        boxes_.add(face, glass, {0.3F - half, y + 0.8F, -0.05F}, {half - 0.3F, y + storey - 0.3F, 0.06F});
      }
    });
  }

  /// Frames, sills, glazing bars, and railings before some windows: rounds of thinner and thinner boxes until the share is used
  /// up.
  void bars() {
    panes([&](const Frame& face, float x0, float x1, float y0, float y1) {
      const float t = 0.06F;
      boxes_.add(face, plaster, {x0 - 0.15F, y0 - 0.12F, 0}, {x1 + 0.15F, y0, 0.22F});
      boxes_.add(face, plaster, {x0 - t, y1, 0}, {x1 + t, y1 + t, 0.12F});
      boxes_.add(face, plaster, {x0 - t, y0, 0}, {x0, y1, 0.12F});
      boxes_.add(face, plaster, {x1, y0, 0}, {x1 + t, y1, 0.12F});
    });
    for (int cells = 2; boxes_.left() > 0 && cells < 40; cells *= 2) {
      panes([&](const Frame& face, float x0, float x1, float y0, float y1) {
        const float t = 0.05F / static_cast<float>(cells);
        for (int i = 1; i < cells; i += 2) {
          const float x = mixed(x0, x1, static_cast<float>(i) / static_cast<float>(cells));
          const float y = mixed(y0, y1, static_cast<float>(i) / static_cast<float>(cells));
          boxes_.add(face, dark_metal, {x - t, y0, 0.02F}, {x + t, y1, 0.08F});
          boxes_.add(face, dark_metal, {x0, y - t, 0.02F}, {x1, y + t, 0.08F});
        }
        if (cells > 2) return;
        for (int i = 0; i <= 8; ++i) {
          const float x = mixed(x0, x1, static_cast<float>(i) / 8);
          boxes_.add(face, dark_metal, {x - 0.015F, y0, 0.16F}, {x + 0.015F, y0 + 0.55F, 0.19F});
        }
      });
    }
  }

  Boxes& boxes_;
  Frame frame_;
  Random random_;
  float height_;
  float width_;
  float pane_ = 2.5F;
  std::uint32_t walls_ = concrete;
  bool tower_ = false;
  std::size_t count_ = 0;
  std::array<Volume, 6> volumes_{};
};

/// Square root rounded to the nearest whole number.
int whole_root(double x) { return static_cast<int>(std::lround(std::sqrt(x))); }

class City {
 public:
  City(std::int64_t triangles, std::uint64_t seed)
      : seed_(seed),
        total_((triangles - 2) / 12),
        side_(std::max(3, whole_root(std::sqrt(static_cast<double>(triangles)) * 0.4))) {}

  /// Of the whole town, in metres.
  [[nodiscard]] float size() const { return lot * static_cast<float>(side_); }
  [[nodiscard]] static Frame frame() {
    // A turn by the angle of the triangle 8, 15, 17: off the axes, and exact.
    return {{0, 0, 0}, {15.0F / 17, 0, 8.0F / 17}, {0, 1, 0}, {-8.0F / 17, 0, 15.0F / 17}};
  }

  void build(Mesh& mesh) const {
    const auto boxes = static_cast<std::size_t>(total_);
    mesh.reserve(8 * boxes + 4, 12 * boxes + 2);
    const float far = size() + 150;
    mesh.material(asphalt);
    mesh.quad({-far, 0, far}, {far, 0, far}, {far, 0, -far}, {-far, 0, -far});
    // Shares go with a house's façades; what earlier houses could not use is passed on, and the last takes up the rest.
    double all = 0;
    for (int k = 0; k < side_; ++k) {
      for (int i = 0; i < side_; ++i) all += weight(plan(i, k));
    }
    double sum = 0;
    std::int64_t used = 0;
    for (int k = 0; k < side_; ++k) {
      for (int i = 0; i < side_; ++i) {
        const Lot here = plan(i, k);
        sum += weight(here);
        const bool last = i + 1 == side_ && k + 1 == side_;
        const auto until = last ? total_ : static_cast<std::int64_t>(static_cast<double>(total_) * (sum / all));
        Boxes budget(mesh, until - used);
        build_lot(budget, here);
        used = until - budget.left();
      }
    }
  }

 private:
  struct Lot {
    Random random;
    Frame place;
    float height;
  };

  [[nodiscard]] Lot plan(int i, int k) const {
    Random random(seed_, static_cast<std::uint64_t>(k) * 100'003 + static_cast<std::uint64_t>(i) + 10);
    const float x = (static_cast<float>(i) + 0.5F) * lot - size() / 2;
    const float z = (static_cast<float>(k) + 0.5F) * lot - size() / 2;
    const float from_middle = 2 * std::sqrt(x * x + z * z) / size();
    const float center = bump(squared(min(1, from_middle))) * min(1, static_cast<float>(side_) / 12);
    const float luck = random.uniform();
    const float height = storey * std::floor(3 + 4 * random.uniform() + center * (6 + 42 * luck * luck * luck + 8 * luck));
    return {random, frame().moved({x, 0, z}), height};
  }

  static double weight(const Lot& here) { return 12 + here.height; }

  static void build_lot(Boxes& boxes, Lot here) {
    Random& random = here.random;
    const Frame& place = here.place;
    const float half = (lot - street) / 2;
    boxes.add(place, pavement, {-half - 3, 0, -half - 3}, {half + 3, 0.18F, half + 3});
    const float width = 2 * half * random.uniform(0.72F, 0.96F);
    // Each house is turned a little its own way, some by an eighth.
    const bool eighth = random.below(6) == 0 && here.height > 60;
    const float turns = eighth ? 0.125F : random.uniform(-0.02F, 0.02F);
    const float c = cos_turns(turns);
    const float s = sin_turns(turns);
    const Frame turned{place.at({0, 0.18F, 0}), place.x * c + place.z * s, place.y, place.z * c - place.x * s};
    if (boxes.left() > 40) furniture(boxes, place, half, random);
    House(boxes, turned, here.height, width * (eighth ? 0.72F : 0.95F), random).build();
  }

  /// Lamps and lane marks.
  static void furniture(Boxes& boxes, const Frame& place, float half, Random& random) {
    for (int i = 0; i < 4; ++i) {
      const float along = mixed(-half, half, (static_cast<float>(i) + 0.5F) / 4);
      boxes.add(place, paint, {along - 1.5F, 0.01F, -lot / 2 - 0.08F}, {along + 1.5F, 0.03F, -lot / 2 + 0.08F});
      boxes.add(place, paint, {-lot / 2 - 0.08F, 0.01F, along - 1.5F}, {-lot / 2 + 0.08F, 0.03F, along + 1.5F});
    }
    for (int i = 0; i < 2; ++i) {
      const float x = mixed(-half, half, 0.25F + 0.5F * static_cast<float>(i));
      boxes.add(place, dark_metal, {x - 0.08F, 0.1F, -half - 2.4F}, {x + 0.08F, 7, -half - 2.24F});
      boxes.add(place, dark_metal, {x - 0.05F, 6.9F, -half - 4.2F}, {x + 0.05F, 7, -half - 2.24F});
    }
    for (int i = 0; i < 3; ++i) {
      const float x = random.uniform(-half, half);
      const std::uint32_t color = random.below(2) == 0 ? static_cast<std::uint32_t>(brick) : static_cast<std::uint32_t>(steel);
      boxes.add(place, color, {x - 2.1F, 0.35F, -lot / 2 + 1.4F}, {x + 2.1F, 0.95F, -lot / 2 + 3.2F});
      boxes.add(place, glass, {x - 1.1F, 0.95F, -lot / 2 + 1.55F}, {x + 1.2F, 1.5F, -lot / 2 + 3.05F});
    }
  }

  std::uint64_t seed_;
  std::int64_t total_;
  int side_;
};

void make_city(Scene& scene, std::int64_t triangles, std::uint64_t seed) {
  const City city(triangles, seed);
  Mesh mesh(false);
  city.build(mesh);
  mesh.move_into(scene);
  scene.materials = {{.name = "asphalt", .color = {0.09F, 0.09F, 0.10F}},
                     {.name = "pavement", .color = {0.40F, 0.39F, 0.37F}},
                     {.name = "concrete", .color = {0.55F, 0.53F, 0.50F}},
                     {.name = "brick", .color = {0.42F, 0.17F, 0.11F}},
                     {.name = "plaster", .color = {0.72F, 0.66F, 0.54F}},
                     {.name = "dark-metal", .color = {0.10F, 0.11F, 0.12F}},
                     {.name = "steel", .color = {0.50F, 0.52F, 0.55F}},
                     {.name = "glass", .kind = MaterialKind::reflective, .color = {0.42F, 0.50F, 0.56F}},
                     {.name = "paint", .color = {0.75F, 0.75F, 0.72F}}};
  scene.lights = {
      {.name = "sun", .position = {0.55F, 0.62F, 0.40F}, .intensity = {1.1F, 1.05F, 0.95F}, .point_at_infinity = true}};
  // The street camera stands on a crossing near the middle and looks along a street.
  const Frame frame = City::frame();
  const float crossing = std::floor(city.size() / lot / 2) * lot - city.size() / 2;
  const float reach = min(city.size(), 12 * lot);
  scene.cameras = {{.name = "skyline",
                    .eye = frame.at({-0.30F * reach, 0.42F * reach + 40, 1.02F * reach}),
                    .target = frame.at({0.02F * reach, 0.10F * reach, 0}),
                    .vertical_fov = 42},
                   {.name = "street",
                    .eye = frame.at({crossing + 2.5F, 2.2F, crossing + 0.32F * reach}),
                    .target = frame.at({crossing - 1.5F, 11, crossing - 0.3F * reach}),
                    .vertical_fov = 62}};
}

const ProceduralRegistration registration{"city", "boxes turned off the axes, with long thin triangles", make_city};

}  // namespace
}  // namespace raystudy::procedural
