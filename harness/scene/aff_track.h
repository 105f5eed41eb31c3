#pragma once

#include <array>
#include <vector>

#include "harness/scene/affine.h"

namespace raystudy {

/// A key of a track: a translation, three scales, or a rotation as unit quaternion (x, y, z, w), with the tension, continuity and
/// bias of the curve there.
template <std::size_t N>
struct AffKey {
  double time = 0;
  std::array<double, N> value{};
  double tension = 0;
  double continuity = 0;
  double bias = 0;
  friend bool operator==(const AffKey&, const AffKey&) = default;
};

/// The key frames of one name in an AFF file (Lext, Assarsson, Moller 2001): splines of Kochanek and Bartels (1984) with tangents
/// adjusted to the distances of the keys. The first and the last key only shape the curve: before the second and after the last
/// but one it stands still. Tracks have no keys, or four and more. BART's files have keys at equal times and go back in time:
/// what counts is the first pair of keys in their order of which the second is later than the time asked for.
struct AffTrack {
  std::vector<AffKey<3>> translation;
  std::vector<AffKey<4>> rotation;
  std::vector<AffKey<3>> scale;
  friend bool operator==(const AffTrack&, const AffTrack&) = default;

  /// Scaled, then turned, then moved; a track without keys does nothing.
  [[nodiscard]] Affine at(double time) const;
};

/// The unit quaternion (x, y, z, w) of a turn by `degrees` around `axis`, which need not be of unit length.
[[nodiscard]] std::array<double, 4> turn_around(const std::array<double, 3>& axis, double degrees);

}  // namespace raystudy
