#pragma once

#include <cstdint>

#include "harness/accel/bvh2.h"
#include "harness/scene/scene.h"
#include "methods/topdown/box_record.h"

namespace raystudy::lbvh {

namespace hn = topdown::hn;
using topdown::Float4;
using topdown::WideBox;

/// The boxes of a scene's triangles, straight from their vertices: those of BoxRecord::of, bit for bit, with 0 in
/// the fourth lanes (of the upper bounds -0).
class TriangleBoxes {
 public:
  explicit TriangleBoxes(const Scene& scene) : triangles_(scene.triangles.data()), vertices_(scene.vertices.data()) {}

  [[nodiscard]] WideBox operator()(std::uint32_t t) const {
    const Triangle& triangle = triangles_[t];
    const auto a = vertex(triangle[0]);
    const auto b = vertex(triangle[1]);
    const auto c = vertex(triangle[2]);
    const auto zero = hn::Zero(Float4());  // added so that no -0 is left
    return WideBox::of(hn::Add(hn::Min(hn::Min(a, b), c), zero), hn::Neg(hn::Add(hn::Max(hn::Max(a, b), c), zero)));
  }

  void prefetch_triangle(std::uint32_t t) const { __builtin_prefetch(triangles_ + t); }
  /// Reads the triangle.
  void prefetch_vertices(std::uint32_t t) const {
    for (int i = 0; i < 3; ++i) __builtin_prefetch(vertices_ + triangles_[t][i]);
  }

 private:
  /// Never reads past the vertex, which may be the last. The fourth lane is 0.
  [[nodiscard]] hn::Vec<Float4> vertex(std::uint32_t v) const {
    const Float4 d;
    const float* const p = &vertices_[v].x;
#if HWY_MAX_BYTES >= 32  // has masked loads
    return hn::MaskedLoad(hn::FirstN(d, 3), d, p);
#else
    alignas(16) const float lanes[4] = {p[0], p[1], p[2], 0};
    return hn::Load(d, lanes);
#endif
  }

  const Triangle* triangles_;
  const Vec3* vertices_;
};

/// Sets a node in two stores.
inline void set_node(Bvh2Node& node, const WideBox& box, std::uint32_t first, std::uint32_t count) {
#if HWY_MAX_BYTES >= 32
  const WideBox::Float8 d;
  alignas(32) static constexpr std::int32_t lanes[8] = {0, 1, 2, 4, 5, 6, 6, 6};
  alignas(32) static constexpr float signs[8] = {0.F, 0.F, 0.F, -0.F, -0.F, -0.F, 0.F, 0.F};
  const auto bounds = hn::TableLookupLanes(box.bounds, hn::SetTableIndices(d, lanes));
  hn::Store(hn::Xor(bounds, hn::Load(d, signs)), d, reinterpret_cast<float*>(&node));
  node.first = first;
  node.count = count;
#else
  node = {box.box(), first, count};
#endif
}

/// The box of a node that set_node made.
[[nodiscard]] inline WideBox box_of(const Bvh2Node& node) {
  const Float4 d;
  const float* const p = &node.box.lower.x;
  return WideBox::of(hn::LoadU(d, p), hn::Neg(hn::LoadU(d, p + 3)));
}

}  // namespace raystudy::lbvh
