#include "methods/wide/node_write.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "harness/base/error.h"

namespace raystudy::wide {

template <int W>
void set_boxes(WideNode<W>& node, std::span<const Box> boxes) {
  for (std::size_t i = 0; i < W; ++i) {
    const Box box = i < boxes.size() ? boxes[i] : Box{};
    for (int axis = 0; axis < 3; ++axis) {
      node.bounds[static_cast<std::size_t>(axis)][0][i] = box.lower[axis];
      node.bounds[static_cast<std::size_t>(axis)][1][i] = box.upper[axis];
    }
  }
}

namespace {

constexpr int steps = 255;

/// The least e for which 255 · 2^e spans from `lower` to `upper`; floats of full range need 2^121 steps at most.
int exponent_for(float lower, float upper) {
  const double extent = static_cast<double>(upper) - static_cast<double>(lower);
  if (!(extent > 0)) return -126;
  return std::clamp(static_cast<int>(std::ceil(std::log2(extent / steps))), -126, 127);
}

struct Axis {
  double origin;
  double scale;

  [[nodiscard]] double below(float plane) const { return std::floor((static_cast<double>(plane) - origin) / scale); }
  [[nodiscard]] double above(float plane) const { return std::ceil((static_cast<double>(plane) - origin) / scale); }
};

}  // namespace

template <int W>
void set_boxes(QuantizedNode<W>& node, std::span<const Box> boxes) {
  Box all;
  for (const Box& box : boxes) all.extend(box);
  node.exponent[3] = static_cast<std::int8_t>(boxes.size());
  for (int axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<std::size_t>(axis);
    node.origin[a] = all.lower[axis];
    int e = exponent_for(all.lower[axis], all.upper[axis]);
    Axis grid{static_cast<double>(all.lower[axis]), std::ldexp(1.0, e)};
    while (grid.above(all.upper[axis]) > steps) grid.scale = std::ldexp(1.0, ++e);  // where log2 was rounded down
    node.exponent[a] = static_cast<std::int8_t>(e);
    for (std::size_t i = 0; i < W; ++i) {
      auto& [lower, upper] = node.bounds[a];
      lower[i] = i < boxes.size() ? static_cast<std::uint8_t>(grid.below(boxes[i].lower[axis])) : std::uint8_t{0};
      upper[i] = i < boxes.size() ? static_cast<std::uint8_t>(grid.above(boxes[i].upper[axis])) : std::uint8_t{0};
    }
  }
}

namespace {

/// W numbers, one a slot. GCC ignores the attribute where its size is a parameter's.
template <int W>
struct Lanes;
template <>
struct Lanes<4> {
  using Floats = float __attribute__((vector_size(16)));
  using Ints = std::int32_t __attribute__((vector_size(16)));
};
template <>
struct Lanes<8> {
  using Floats = float __attribute__((vector_size(32)));
  using Ints = std::int32_t __attribute__((vector_size(32)));
};
template <>
struct Lanes<16> {
  using Floats = float __attribute__((vector_size(64)));
  using Ints = std::int32_t __attribute__((vector_size(64)));
};

}  // namespace

template <int W>
SlotOrders<W> slot_orders(std::span<const Box> boxes) {
  using Floats = typename Lanes<W>::Floats;
  using Ints = typename Lanes<W>::Ints;
  const std::size_t used = boxes.size();
  const std::size_t unused = W - used;
  Floats x{};
  Floats y{};
  Floats z{};
  Ints slot{};
  for (std::size_t i = 0; i < W; ++i) slot[i] = static_cast<std::int32_t>(i);
  for (std::size_t i = 0; i < used; ++i) {
    const Vec3 c = boxes[i].lower * 0.5F + boxes[i].upper * 0.5F;
    x[i] = c.x, y[i] = c.y, z[i] = c.z;
  }
  SlotOrders<W> orders;
  for (unsigned row = 0; row < orders.size(); ++row) {
    const Floats distance = ((row & 1U) != 0 ? -x : x) + ((row & 2U) != 0 ? -y : y) + z;
    // A slot's place is the number of those before it: the farther ones, and of equals the earlier. Sums of three finite numbers
    // may be infinite but are numbers, so that no two share a place.
    Ints place{};
    for (std::size_t i = 0; i < used; ++i) {
      const Floats other = distance[i] - Floats{};
      place -= (other > distance) | ((other == distance) & (slot > static_cast<std::int32_t>(i)));
    }
    for (std::size_t i = 0; i < unused; ++i) orders[row][i] = static_cast<std::uint8_t>(used + i);
    for (std::size_t i = 0; i < used; ++i) {
      orders[row][unused + static_cast<std::size_t>(place[i])] = static_cast<std::uint8_t>(i);
    }
  }
  return orders;
}

void check_triangle_count(std::size_t count) {
  if (count <= WideChild::most_first) return;
  throw Error(fmt::format("a wide tree can refer to {} triangles at most; this one has more", WideChild::most_first));
}

std::uint32_t write_leaf(WideBvh& bvh, const Scene& scene, std::uint32_t first, std::span<const std::uint32_t> triangles) {
  const std::size_t n = triangles.size();
  float* const rows = bvh.corners.data() + std::size_t{9} * first;
  for (std::size_t i = 0; i < n; ++i) {
    const Triangle& triangle = scene.triangles[triangles[i]];
    for (int corner = 0; corner < 3; ++corner) {
      const Vec3 p = scene.vertices[triangle[corner]];
      for (int axis = 0; axis < 3; ++axis) rows[n * static_cast<std::size_t>(3 * axis + corner) + i] = p[axis];
    }
  }
  std::copy(triangles.begin(), triangles.end(), bvh.triangles.begin() + first);
  return WideChild::leaf(first, static_cast<std::uint32_t>(n));
}

template SlotOrders<4> slot_orders<4>(std::span<const Box>);
template SlotOrders<8> slot_orders<8>(std::span<const Box>);
template SlotOrders<16> slot_orders<16>(std::span<const Box>);
template void set_boxes(WideNode<4>&, std::span<const Box>);
template void set_boxes(WideNode<8>&, std::span<const Box>);
template void set_boxes(WideNode<16>&, std::span<const Box>);
template void set_boxes(QuantizedNode<4>&, std::span<const Box>);
template void set_boxes(QuantizedNode<8>&, std::span<const Box>);
template void set_boxes(QuantizedNode<16>&, std::span<const Box>);

}  // namespace raystudy::wide
