#include "scenes/procedural/ornament.h"

#include <algorithm>
#include <cmath>

#include "scenes/procedural/noise.h"
#include "scenes/procedural/numeric.h"

namespace raystudy::procedural {
namespace {

/// Roughness of dressed stone, in metres: what makes a patch of many cells differ from a smooth one.
float stone(Vec3 p, std::uint32_t seed) { return 0.004F * fractal_noise(p * 9.0F, 3, seed); }

Vec3 around(float radius, float turns, float height) { return {radius * cos_turns(turns), height, radius * sin_turns(turns)}; }

/// A leaf of unit width and height that curls outwards at its tip: how far it stands out at (x in [-1, 1], y in [0, 1]).
float leaf(float x, float y) {
  const float outline = 1 - squared(squared(y));
  const float across = std::fabs(x) / max(0.2F, outline);
  if (across >= 1) return 0;
  const float rib = 1 - 0.35F * bump(squared(x * 5));
  const float lobes = 1 - 0.25F * squared(sin_turns(y * 2.5F)) * across;
  return (0.35F + 0.65F * y * y) * (1 - across * across) * rib * lobes;
}

}  // namespace

ProfilePoint on_profile(std::span<const ProfilePoint> profile, float t) {
  const auto last = static_cast<int>(profile.size()) - 1;
  const float x = clamped(t, 0, 1) * static_cast<float>(last);
  const int i = std::min(static_cast<int>(x), last - 1);
  const float f = x - static_cast<float>(i);
  const auto point = [&](int k) { return profile[static_cast<std::size_t>(std::clamp(k, 0, last))]; };
  const auto curve = [f](float a, float b, float c, float d) {
    return b + 0.5F * f * (c - a + f * (2 * a - 5 * b + 4 * c - d + f * (3 * (b - c) + d - a)));
  };
  const ProfilePoint a = point(i - 1);
  const ProfilePoint b = point(i);
  const ProfilePoint c = point(i + 1);
  const ProfilePoint d = point(i + 2);
  return {curve(a.radius, b.radius, c.radius, d.radius), curve(a.height, b.height, c.height, d.height)};
}

void revolve(Mesh& mesh, Detail& detail, const Frame& frame, std::span<const ProfilePoint> profile, float weight_u,
             float weight_v, int least_u, int least_v) {
  const int nu = detail.cells(weight_u, least_u);
  const int nv = detail.cells(weight_v, least_v);
  mesh.grid(nu, nv, true, [&](float u, float v) {
    const ProfilePoint p = on_profile(profile, v);
    return frame.at(around(p.radius, -u, p.height));
  });
}

void column(Mesh& mesh, Detail& detail, const Frame& frame, const ColumnStyle& style, std::uint32_t stone_seed) {
  const float r = style.radius;
  const float plinth = style.complete ? 0.5F * r : 0;
  const float base = style.complete ? 0.7F * r : 0;
  const float abacus = style.complete ? 0.3F * r : 0;
  const float capital = 1.9F * r;
  const float foot = plinth + base;
  const float neck = style.height - abacus - capital;
  if (style.complete) {
    mesh.box(frame, {-1.4F * r, 0, -1.4F * r}, {1.4F * r, plinth, 1.4F * r});
    const std::array<ProfilePoint, 7> torus{{{1.36F * r, plinth},
                                             {1.42F * r, plinth + 0.3F * base},
                                             {1.22F * r, plinth + 0.45F * base},
                                             {1.12F * r, plinth + 0.55F * base},
                                             {1.24F * r, plinth + 0.75F * base},
                                             {1.14F * r, plinth + 0.9F * base},
                                             {1.02F * r, foot}}};
    revolve(mesh, detail, frame, torus, 24, 8);
    mesh.box(frame, {-1.5F * r, style.height - abacus, -1.5F * r}, {1.5F * r, style.height, 1.5F * r});
  }
  constexpr int flutes = 16;
  const int per_flute = detail.cells(3.0, 0);
  const bool fluted = per_flute >= 3;
  const int nu = fluted ? flutes * per_flute : detail.cells(24, 6);
  mesh.grid(nu, detail.cells(9, 1), true, [&](float u, float v) {
    const float y = mixed(foot, neck, v);
    // The shaft narrows by a sixth in a slightly swelling line; flutes end in round stops above the base and below the neck.
    float radius = r * (1 - 0.17F * v * v);
    if (fluted) {
      const float f = u * flutes - std::floor(u * flutes);
      const float stops = smooth_step(0, 0.05F, v) * (1 - smooth_step(0.95F, 1, v));
      radius -= 0.09F * r * stops * (1 - squared(2 * f - 1));
    }
    const Vec3 p = frame.at(around(radius, -u, y));
    return p + frame.at(around(stone(p, stone_seed), -u, 0)) - frame.origin;
  });
  const int around_capital = detail.cells(40, 6);
  const bool leaves = around_capital >= 40;
  mesh.grid(around_capital, detail.cells(16, 1), true, [&](float u, float v) {
    float radius = r * mixed(0.86F, 1.32F, v * v * v);
    if (leaves) {
      const auto row = [&](float shift, float from, float to) {
        const float y = (v - from) / (to - from);
        if (y < 0 || y > 1) return 0.0F;
        const float x = u * 8 + shift;
        return leaf(2 * (x - std::floor(x)) - 1, y);
      };
      radius += 0.28F * r * max(row(0, 0.02F, 0.55F), row(0.5F, 0.25F, 0.92F));
    }
    return frame.at(around(radius, -u, neck + v * capital));
  });
}

void arch(Mesh& mesh, Detail& detail, const Frame& frame, const ArchStyle& style) {
  const Vec3 center{style.width / 2, 0, 0};
  // A point that runs along the wall's edge from the right foot over the top to the left foot; the arch lies below it, seen from
  // the center, so that the corners of the wall are corners of the grid.
  const auto edge = [&](float u) {
    if (u <= 0.25F) return Vec3{style.width, style.top * u * 4, 0};
    if (u <= 0.75F) return Vec3{style.width * (1.5F - 2 * u), style.top, 0};
    return Vec3{0, style.top * (1 - u) * 4, 0};
  };
  const auto on_circle = [&](float u, float radius) { return center + normalized(edge(u) - center) * radius; };
  const int nu = 4 * detail.cells(5, 1);
  const auto face = [&](float z, bool front) {
    mesh.grid(nu, 1, false, [&](float u, float v) {
      const float w = front ? u : 1 - u;
      return frame.at((v == 0 ? on_circle(w, style.radius) : edge(w)) + Vec3{0, 0, z});
    });
  };
  face(-style.depth, false);
  face(style.depth, true);
  mesh.grid(nu, detail.cells(2, 1), false, [&](float u, float v) {
    return frame.at(on_circle(u, style.radius) + Vec3{0, 0, mixed(-style.depth, style.depth, v)});
  });
  if (!style.moulding) return;
  const std::array<ProfilePoint, 8> archivolt{
      {{0, 0}, {0.01F, 0.05F}, {0.05F, 0.06F}, {0.06F, 0.03F}, {0.12F, 0.03F}, {0.14F, 0.08F}, {0.20F, 0.07F}, {0.21F, 0}}};
  for (const float direction : {-1.0F, 1.0F}) {
    mesh.grid(4 * detail.cells(8, 2), detail.cells(10, 3), false, [&](float u, float v) {
      const ProfilePoint p = on_profile(archivolt, v);
      return frame.at(on_circle(direction < 0 ? u : 1 - u, style.radius + p.radius) +
                      Vec3{0, 0, direction * (style.depth + p.height)});
    });
    const float half = 0.11F;
    mesh.box(frame, {center.x - half, style.radius - 0.04F, direction < 0 ? -style.depth - 0.13F : style.depth},
             {center.x + half, style.radius + 0.34F, direction < 0 ? -style.depth : style.depth + 0.13F});
  }
}

void groin_vault(Mesh& mesh, Detail& detail, const Frame& frame, float width, float depth, float rise, std::uint32_t stone_seed) {
  const int n = 2 * detail.cells(7, 1);
  mesh.grid(n, n, false, [&](float u, float v) {
    // Even angles, not even distances: the barrels rise steeply at their springing.
    const float x = -cos_turns(u * 0.5F);
    const float z = -cos_turns(v * 0.5F);
    const float y = max(sin_turns(u * 0.5F), sin_turns(v * 0.5F));
    const Vec3 p = frame.at({width * (0.5F + 0.5F * x), rise * y, depth * (0.5F + 0.5F * z)});
    return p + frame.y * stone(p, stone_seed);
  });
}

void moulding(Mesh& mesh, Detail& detail, const Frame& frame, float from, float to, std::span<const ProfilePoint> profile,
              float weight_along, float weight_profile) {
  mesh.grid(detail.cells(weight_along, 1), detail.cells(weight_profile, static_cast<int>(profile.size()) / 2), false,
            [&](float u, float v) {
              const ProfilePoint p = on_profile(profile, v);
              return frame.at({mixed(from, to, u), p.height, -p.radius});
            });
}

void baluster(Mesh& mesh, Detail& detail, const Frame& frame, float height) {
  constexpr std::array<ProfilePoint, 11> shape{{{0.085F, 0},
                                                {0.085F, 0.06F},
                                                {0.05F, 0.09F},
                                                {0.055F, 0.14F},
                                                {0.10F, 0.30F},
                                                {0.085F, 0.44F},
                                                {0.045F, 0.66F},
                                                {0.04F, 0.80F},
                                                {0.07F, 0.86F},
                                                {0.05F, 0.90F},
                                                {0.08F, 1}}};
  std::array<ProfilePoint, 11> scaled = shape;
  for (ProfilePoint& p : scaled) p.height *= height;
  revolve(mesh, detail, frame, scaled, 10, 14, 4, 3);
}

void rosette(Mesh& mesh, Detail& detail, const Frame& frame, float radius, int petals) {
  const int nu = std::max(2 * petals, detail.cells(56, 8));
  mesh.grid(nu, detail.cells(24, 4), true, [&](float u, float v) {
    const float r = mixed(0.03F, 1, v);
    const auto ring = [&](float shift, float from, float to) {
      const float y = (r - from) / (to - from);
      if (y < 0 || y > 1) return 0.0F;
      const float x = u * static_cast<float>(petals) + shift;
      const float across = (2 * (x - std::floor(x)) - 1) / max(0.15F, sin_turns(0.5F * y));
      return across * across >= 1 ? 0.0F : (1 - across * across) * sin_turns(0.5F * y) * (1 - 0.3F * bump(squared(across * 4)));
    };
    const float rim = bump(squared((r - 0.93F) / 0.07F));
    const float boss = bump(squared(r / 0.16F));
    const float relief = 0.11F * max(ring(0, 0.12F, 0.52F), 0.85F * ring(0.5F, 0.30F, 0.86F)) + 0.09F * rim + 0.12F * boss;
    return frame.at({radius * r * cos_turns(u), radius * r * sin_turns(u), -radius * (0.02F * (1 - v) + relief)});
  });
}

void banner(Mesh& mesh, Detail& detail, const Frame& frame, float width, float drop, float phase) {
  mesh.grid(detail.cells(24, 4), detail.cells(20, 2), false, [&](float u, float v) {
    const float depth = 0.05F + 0.12F * v;
    const float fold = depth * (sin_turns(3.5F * u + phase + 0.25F * v) + 0.4F * sin_turns(7.3F * u - phase));
    const float sag = 0.12F * sin_turns(0.5F * u) * (1 - v);
    const float hem = 0.25F * v * std::fabs(2 * u - 1);
    return frame.at({width * u, -drop * v - sag + hem * 0.4F, fold});
  });
}

}  // namespace raystudy::procedural
