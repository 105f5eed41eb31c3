#pragma once

#include <cstdint>
#include <span>

#include "harness/accel/wide_bvh.h"
#include "harness/scene/scene.h"

namespace raystudy::wide {

/// Writes the boxes of a node's first slots; the other slots get empty boxes.
template <int W>
void set_boxes(WideNode<W>& node, std::span<const Box> boxes);
/// The same on the finest grid of powers of two that holds them all; each plane is rounded away from its box.
template <int W>
void set_boxes(QuantizedNode<W>& node, std::span<const Box> boxes);

/// The orders in which rays meet boxes, those of a node's used slots.
template <int W>
[[nodiscard]] SlotOrders<W> slot_orders(std::span<const Box> boxes);

/// Throws Error past the 2^27 triangles a tree can hold.
void check_triangle_count(std::size_t count);

/// Writes a leaf of 1 to 16 triangles with their corners at `first` of a tree's triangles, where there is room for them, and
/// returns the slot's content.
std::uint32_t write_leaf(WideBvh& bvh, const Scene& scene, std::uint32_t first, std::span<const std::uint32_t> triangles);

}  // namespace raystudy::wide
