#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "harness/base/parallel.h"
#include "harness/scene/procedural.h"
#include "scenes/procedural/bust.h"
#include "scenes/procedural/noise.h"
#include "scenes/procedural/numeric.h"
#include "scenes/procedural/ornament.h"
#include "scenes/procedural/random.h"

namespace raystudy::procedural {
namespace {

/// The bust's outline before carving: distance from the axis and height, in metres, from the socle's underside to the crown.
constexpr std::array<ProfilePoint, 31> outline{
    {{0.000F, 0.000F}, {0.060F, 0.000F}, {0.122F, 0.001F}, {0.128F, 0.008F}, {0.127F, 0.022F}, {0.112F, 0.031F}, {0.086F, 0.042F},
     {0.074F, 0.060F}, {0.070F, 0.085F}, {0.074F, 0.110F}, {0.090F, 0.124F}, {0.096F, 0.132F}, {0.100F, 0.146F}, {0.132F, 0.180F},
     {0.166F, 0.220F}, {0.196F, 0.260F}, {0.204F, 0.296F}, {0.186F, 0.330F}, {0.136F, 0.356F}, {0.088F, 0.374F}, {0.067F, 0.396F},
     {0.062F, 0.424F}, {0.066F, 0.444F}, {0.077F, 0.466F}, {0.086F, 0.500F}, {0.092F, 0.540F}, {0.095F, 0.580F}, {0.091F, 0.618F},
     {0.074F, 0.650F}, {0.042F, 0.670F}, {0.000F, 0.676F}}};

/// Blends by height: the value of the last row below y and the first above.
template <std::size_t N>
float by_height(const std::array<std::array<float, 2>, N>& rows, float y) {
  for (std::size_t i = 1; i < N; ++i) {
    if (y < rows[i][0]) return mixed(rows[i - 1][1], rows[i][1], smooth_step(rows[i - 1][0], rows[i][0], y));
  }
  return rows.back()[1];
}
constexpr std::array<std::array<float, 2>, 5> widths{{{0.13F, 1}, {0.22F, 1.12F}, {0.32F, 1.10F}, {0.39F, 1}, {0.50F, 0.86F}}};
constexpr std::array<std::array<float, 2>, 5> depths{
    {{0.13F, 1}, {0.22F, 0.72F}, {0.32F, 0.66F}, {0.39F, 0.96F}, {0.52F, 1.08F}}};
constexpr std::array<std::array<float, 2>, 3> forward{{{0.36F, 0}, {0.42F, 0.006F}, {0.50F, 0.016F}}};

/// A smooth blob of unit height around (x0, y0) with half axes w and h.
float blob(float x, float y, float x0, float y0, float w, float h) { return bump(squared((x - x0) / w) + squared((y - y0) / h)); }

/// The carved bust: where the point at `turns` around the axis (0: the face) and at outline position `base` lies.
class Bust {
 public:
  Bust(std::uint64_t seed, float spacing) : seed_(static_cast<std::uint32_t>(mix(seed))) {
    Random random(seed, 2);
    nose_ = random.uniform(0.9F, 1.15F);
    brow_ = random.uniform(0.8F, 1.3F);
    beard_ = random.uniform(0.85F, 1.25F);
    // From 1 cm down to a wavelength of two triangles.
    while (roughness_octaves_ < 6 && 0.01F / static_cast<float>(1 << roughness_octaves_) > 2 * spacing) ++roughness_octaves_;
  }

  [[nodiscard]] Vec3 at(float turns, ProfilePoint base, ProfilePoint normal) const {
    const float y = base.height;
    const float side = sin_turns(turns);
    const float front = cos_turns(turns);
    const Vec3 p{base.radius * by_height(widths, y) * side, y, base.radius * by_height(depths, y) * front};
    const float out = relief(p, front, side);
    return p + Vec3{out * normal.radius * side, out * normal.height, out * normal.radius * front + by_height(forward, y)};
  }

 private:
  [[nodiscard]] float relief(Vec3 p, float front, float side) const {
    float out = 0.00025F * fractal_noise(p * 100.0F, roughness_octaves_, seed_ ^ 0x77U);
    if (p.y > 0.13F && p.y < 0.40F) out += drapery(p, front);
    if (p.y > 0.40F) out += head(p, front, side);
    return out;
  }

  /// Folds that run from the left shoulder across the chest.
  [[nodiscard]] float drapery(Vec3 p, float front) const {
    const float mask = smooth_step(0.135F, 0.165F, p.y) * (1 - smooth_step(0.345F, 0.375F, p.y + 0.12F * p.x));
    const float warp = 0.35F * gradient_noise(p * 9.0F, seed_ ^ 0x11U) + 0.10F * gradient_noise(p * 27.0F, seed_ ^ 0x12U);
    const float across = (p.y * 0.9F - p.x * 0.55F + 0.18F * front * p.z) * 17 + 1.2F * warp;
    const float fold = sin_turns(across) + 0.4F * sin_turns(2.3F * across + 0.3F);
    const float chest = 0.012F * blob(std::fabs(p.x), p.y, 0.075F, 0.27F, 0.08F, 0.06F) * smooth_step(0, 0.4F, front);
    return chest + mask * 0.0065F * fold;
  }

  [[nodiscard]] float head(Vec3 p, float front, float side) const {
    const float ax = std::fabs(p.x);
    float out = front > 0.1F ? smooth_step(0.1F, 0.5F, front) * face(ax, p.y) : 0;
    out += ear(p, std::fabs(side));
    // Hair reaches down to the brow's height in front, to the neck behind; the beard covers jaw and chin.
    const float hairline =
        front > 0 ? mixed(0.545F, 0.618F, smooth_step(0, 0.75F, front)) : mixed(0.545F, 0.440F, smooth_step(0, 0.6F, -front));
    const float hair = smooth_step(-0.004F, 0.010F, p.y - hairline);
    const float cheek = mixed(0.482F, 0.545F, smooth_step(0.030F, 0.078F, ax));
    const float mouth = blob(ax, p.y, 0, 0.4945F, 0.026F, 0.011F);
    const float chin = smooth_step(-0.05F, 0.25F, front) * smooth_step(0.415F, 0.440F, p.y) *
                       (1 - smooth_step(cheek - 0.006F, cheek + 0.010F, p.y)) * (1 - mouth);
    const float moustache = smooth_step(0.5F, 0.8F, front) * blob(ax, p.y, 0.016F, 0.5035F - 0.25F * ax, 0.026F, 0.0075F);
    if (hair > 0) out += hair * (0.007F + curls(p, 52, 0.0075F));
    if (chin > 0) {
      out += beard_ * chin * (0.008F + 0.014F * blob(ax, p.y, 0, 0.452F, 0.05F, 0.05F) + curls(p + Vec3{3, 0, 0}, 60, 0.0065F));
    }
    if (moustache > 0) out += moustache * (0.0055F + curls(p, 90, 0.002F));
    return out;
  }

  [[nodiscard]] float face(float ax, float y) const {
    const float down = clamped((0.574F - y) / 0.050F, 0, 1.25F);  // along the nose from its root to its tip
    const float bridge = y > 0.514F && y < 0.585F ? bump(squared(ax / mixed(0.009F, 0.0135F, min(1, down)))) : 0;
    const float tip = 1 - smooth_step(1.0F, 1.2F, down);
    float out = nose_ * bridge * smooth_step(-0.15F, 0.25F, (0.585F - y) * 20 - 0.1F) * (0.004F + 0.021F * down) * tip;
    out += nose_ * 0.008F * blob(ax, y, 0.0125F, 0.5235F, 0.0085F, 0.0085F);  // wings
    out -= 0.0145F * blob(ax, y, 0.0315F, 0.5555F, 0.027F, 0.0175F);          // sockets
    out += 0.0105F * blob(ax, y, 0.0315F, 0.5545F, 0.0165F, 0.0115F);         // eyeballs
    out +=
        0.0030F * bump(squared((y - 0.5605F + 6.0F * squared(ax - 0.0315F)) / 0.0030F)) * bump(squared((ax - 0.0315F) / 0.019F));
    out +=
        0.0024F * bump(squared((y - 0.5480F - 6.0F * squared(ax - 0.0315F)) / 0.0026F)) * bump(squared((ax - 0.0315F) / 0.018F));
    out += brow_ * 0.0075F * bump(squared((y - 0.5760F - 0.10F * ax + 3.0F * squared(ax - 0.02F)) / 0.0105F)) *
           bump(squared((ax - 0.030F) / 0.034F));
    out += 0.0065F * blob(ax, y, 0.046F, 0.532F, 0.030F, 0.022F);    // cheek bones
    out -= 0.0040F * blob(ax, y, 0.045F, 0.505F, 0.024F, 0.020F);    // hollow cheeks
    out += 0.0062F * blob(ax, y, 0.004F, 0.4990F, 0.021F, 0.0052F);  // lips
    out += 0.0068F * blob(ax, y, 0, 0.4895F, 0.019F, 0.0058F);
    out -= 0.0042F * blob(ax, y, 0, 0.4942F, 0.024F, 0.0020F);
    out -= 0.0018F * bump(squared((y - 0.598F) / 0.0022F)) * bump(squared(ax / 0.04F));  // furrows
    out -= 0.0015F * bump(squared((y - 0.606F) / 0.0020F)) * bump(squared(ax / 0.034F));
    return out;
  }

  [[nodiscard]] static float ear(Vec3 p, float side) {
    const float along = p.z + 0.008F + 0.15F * (p.y - 0.543F);
    const float shell = blob(along, p.y, 0, 0.543F, 0.019F, 0.033F);
    const float hollow = blob(along, p.y, 0.004F, 0.548F, 0.011F, 0.019F);
    return smooth_step(0.75F, 0.95F, side) * (0.017F * shell - 0.013F * hollow);
  }

  /// Locks: a ridged noise bent by a coarser one, so that its lines curl.
  [[nodiscard]] float curls(Vec3 p, float frequency, float height) const {
    const Vec3 q = p * (0.5F * frequency);
    const float turn = gradient_noise(q, seed_ ^ 0x21U);
    const Vec3 bend{turn, gradient_noise(q + Vec3{7, 3, 1}, seed_ ^ 0x22U), -turn};
    const Vec3 r = p * frequency + bend * 1.5F;
    const float lock = 1 - 2.2F * std::fabs(gradient_noise(r, seed_ ^ 0x24U));
    const float strands = 1 - 2.0F * std::fabs(gradient_noise(r * 3.1F + bend, seed_ ^ 0x25U));
    return height * (lock + 0.3F * strands - 0.3F);
  }

  std::uint32_t seed_;
  float nose_ = 1;
  float brow_ = 1;
  float beard_ = 1;
  int roughness_octaves_ = 0;
};

/// Points of the outline at even distances, and the outline's normals there.
struct Rings {
  std::vector<ProfilePoint> points;
  std::vector<ProfilePoint> normals;
  std::vector<std::uint32_t> sizes;  // vertices of each ring; the poles are rings of one
};

double outline_length(std::vector<double>& lengths) {
  constexpr int samples = 8192;
  lengths.assign(samples + 1, 0);
  ProfilePoint before = on_profile(outline, 0);
  for (int i = 1; i <= samples; ++i) {
    const ProfilePoint p = on_profile(outline, static_cast<float>(i) / samples);
    const double dr = p.radius - before.radius;
    const double dy = p.height - before.height;
    lengths[static_cast<std::size_t>(i)] = lengths[static_cast<std::size_t>(i) - 1] + std::sqrt(dr * dr + dy * dy);
    before = p;
  }
  return lengths.back();
}

/// Rings such that triangles are near equilateral and twice the sum of the ring sizes is near `triangles`: a strip between two
/// rings has as many triangles as the rings have vertices.
Rings make_rings(std::int64_t triangles) {
  std::vector<double> lengths;
  const double total = outline_length(lengths);
  const double area = 0.62;  // of the outline's surface in square metres: only the first guess of the spacing
  const double edge = std::sqrt(area / static_cast<double>(triangles) * 4 / 1.7320508);
  const int count = std::max(6, static_cast<int>(std::lround(total / (edge * 0.8660254))));
  Rings rings;
  std::vector<double> perimeters;
  std::size_t at = 0;
  for (int i = 1; i < count; ++i) {
    const double wanted = total * i / count;
    while (lengths[at + 1] < wanted) ++at;
    const double f = (wanted - lengths[at]) / (lengths[at + 1] - lengths[at]);
    const auto t = static_cast<float>((static_cast<double>(at) + f) / static_cast<double>(lengths.size() - 1));
    const ProfilePoint p = on_profile(outline, t);
    const ProfilePoint a = on_profile(outline, t - 1e-3F);
    const ProfilePoint b = on_profile(outline, t + 1e-3F);
    const float norm = std::sqrt(squared(b.radius - a.radius) + squared(b.height - a.height));
    rings.points.push_back(p);
    rings.normals.push_back({(b.height - a.height) / norm, (a.radius - b.radius) / norm});
    const float wide = p.radius * by_height(widths, p.height);
    const float deep = p.radius * by_height(depths, p.height);
    perimeters.push_back(std::sqrt(0.5 * (squared(wide) + squared(deep))));
  }
  double sum = 0;
  for (const double p : perimeters) sum += p;
  const double scale = static_cast<double>(triangles) / 2 / sum;
  double carried = 0.5;
  for (const double p : perimeters) {
    carried += p * scale;
    const auto size = std::max(3U, static_cast<std::uint32_t>(carried));
    carried -= size;
    rings.sizes.push_back(size);
  }
  return rings;
}

/// Joins ring `low` of n vertices and ring `high` of m, both counted around from the same angle; odd rings are turned by half a
/// cell. Always goes on where the next corner lies nearer.
void join(std::uint32_t low, std::uint64_t n, std::uint32_t high, std::uint64_t m, bool low_turned, Triangle* out) {
  std::uint64_t a = 0;
  std::uint64_t b = 0;
  const auto around = [](std::uint64_t corner, std::uint64_t size) {
    return static_cast<std::uint32_t>(corner == size ? 0 : corner);
  };
  while (a < n || b < m) {
    const std::uint32_t from = low + around(a, n);
    const std::uint32_t to = high + around(b, m);
    const std::uint64_t next_low = (2 * (a + 1) + (low_turned ? 1 : 0)) * m;
    const std::uint64_t next_high = (2 * (b + 1) + (low_turned ? 0 : 1)) * n;
    if (b == m || (a < n && next_low <= next_high)) {
      *out++ = {{from, low + around(a + 1, n), to}};
      ++a;
    } else {
      *out++ = {{from, high + around(b + 1, m), to}};
      ++b;
    }
  }
}

}  // namespace

Surface bust(std::int64_t triangles, std::uint64_t seed) {
  const Rings rings = make_rings(triangles);
  const std::size_t count = rings.sizes.size();
  std::vector<std::size_t> first(count + 1, 1);  // vertex 0 is the lower pole
  for (std::size_t i = 0; i < count; ++i) first[i + 1] = first[i] + rings.sizes[i];
  const std::size_t top = first[count];
  std::vector<Vec3> vertices(top + 1);
  std::vector<Triangle> corners(2 * (top - 1));
  const float spacing = rings.points.size() > 8 ? 1.35F / static_cast<float>(count) : 0.1F;
  const Bust carved(seed, spacing);
  vertices[0] = carved.at(0, outline.front(), {0, -1});
  vertices[top] = carved.at(0, outline.back(), {0, 1});
  parallel_for_indices(count, [&](std::size_t i) {
    const std::uint32_t n = rings.sizes[i];
    for (std::uint32_t k = 0; k < n; ++k) {
      // The rings start behind the head, where nobody looks.
      const float turns = 0.5F + (static_cast<float>(k) + (i % 2 == 1 ? 0.5F : 0)) / static_cast<float>(n);
      vertices[first[i] + k] = carved.at(turns, rings.points[i], rings.normals[i]);
    }
  });
  const auto index = [&](std::size_t i) { return static_cast<std::uint32_t>(first[i]); };
  for (std::uint32_t k = 0; k < rings.sizes[0]; ++k) corners[k] = {{0, index(0) + (k + 1) % rings.sizes[0], index(0) + k}};
  parallel_for_indices(count - 1, [&](std::size_t i) {
    // Strips 0 to i - 1 hold the vertices of rings 0 to i - 1 and of rings 1 to i; before them comes the fan over ring 0.
    const std::size_t before = (first[i] - 1) + (first[i + 1] - 1);
    join(index(i), rings.sizes[i], index(i + 1), rings.sizes[i + 1], i % 2 == 1, &corners[before]);
  });
  const std::uint32_t last = rings.sizes[count - 1];
  Triangle* cap = &corners[corners.size() - last];
  for (std::uint32_t k = 0; k < last; ++k) {
    cap[k] = {{index(count - 1) + k, index(count - 1) + (k + 1) % last, static_cast<std::uint32_t>(top)}};
  }
  return {std::move(vertices), std::move(corners)};
}

namespace {

void make_scan(Scene& scene, std::int64_t triangles, std::uint64_t seed) {
  Surface surface = bust(triangles, seed);
  scene.vertices = SharedArray<Vec3>(std::move(surface.vertices));
  scene.triangles = SharedArray<Triangle>(std::move(surface.triangles));
  scene.materials = {{.name = "marble", .color = {0.58F, 0.55F, 0.50F}}};
  scene.lights = {
      {.name = "key", .position = {-0.75F, 0.75F, 0.62F}, .intensity = Vec3{1}, .point_at_infinity = true},
      {.name = "rim", .position = {0.9F, 0.25F, -0.5F}, .intensity = {0.35F, 0.38F, 0.45F}, .point_at_infinity = true}};
  scene.cameras = {{.name = "bust", .eye = {0.42F, 0.46F, 1.15F}, .target = {0, 0.335F, 0}, .vertical_fov = 36},
                   {.name = "face", .eye = {-0.22F, 0.55F, 0.46F}, .target = {0.005F, 0.53F, 0.03F}, .vertical_fov = 32}};
}

const ProceduralRegistration registration{"scan", "bust as a scanner sees it: one closed surface of even triangles", make_scan};

}  // namespace
}  // namespace raystudy::procedural
