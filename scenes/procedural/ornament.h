#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "scenes/procedural/detail.h"
#include "scenes/procedural/mesh.h"

namespace raystudy::procedural {

/// A point of a profile: distance from the axis, height.
struct ProfilePoint {
  float radius = 0;
  float height = 0;
};

/// The profile at t in [0, 1] as a smooth curve through its points (Catmull-Rom, evenly in their number).
[[nodiscard]] ProfilePoint on_profile(std::span<const ProfilePoint> profile, float t);

/// A surface of revolution around the frame's y axis of about weight_u · density cells around and weight_v · density along.
void revolve(Mesh& mesh, Detail& detail, const Frame& frame, std::span<const ProfilePoint> profile, float weight_u,
             float weight_v, int least_u = 6, int least_v = 2);

struct ColumnStyle {
  float radius = 0.3F;
  float height = 3.5F;   ///< from the plinth's foot to the abacus' top
  bool complete = true;  ///< with plinth, base and abacus; else shaft and capital only
};
/// A column on the frame's origin: square plinth, moulded base, fluted shaft that narrows upwards, capital of two rows of leaves.
void column(Mesh& mesh, Detail& detail, const Frame& frame, const ColumnStyle& style, std::uint32_t stone_seed);

struct ArchStyle {
  float width = 3;      ///< of the bay
  float radius = 1.2F;  ///< of the opening's half circle
  float top = 2;        ///< height of the wall above the springing line
  float depth = 0.3F;   ///< half the wall's thickness
  bool moulding = true;
};
/// A wall from x = 0 to `width`, y = 0 (the springing line) to `top`, pierced by a round arch, with moulded archivolts.
void arch(Mesh& mesh, Detail& detail, const Frame& frame, const ArchStyle& style);

/// A groin vault over [0, width] × [0, depth] in x and z that springs at y = 0 and rises by `rise`.
void groin_vault(Mesh& mesh, Detail& detail, const Frame& frame, float width, float depth, float rise, std::uint32_t stone_seed);

/// A moulding along x from `from` to `to`; the profile's radius is how far it stands out towards -z.
void moulding(Mesh& mesh, Detail& detail, const Frame& frame, float from, float to, std::span<const ProfilePoint> profile,
              float weight_along, float weight_profile);

/// A turned baluster of the given height.
void baluster(Mesh& mesh, Detail& detail, const Frame& frame, float height);

/// A carved disc in the plane z = 0 around the origin that stands out towards -z: rings of petals.
void rosette(Mesh& mesh, Detail& detail, const Frame& frame, float radius, int petals);

/// A cloth that hangs down from the frame's x axis, `width` wide and `drop` long, in folds.
void banner(Mesh& mesh, Detail& detail, const Frame& frame, float width, float drop, float phase);

}  // namespace raystudy::procedural
