#pragma once

#include <hwy/highway.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

#include "harness/geometry/box.h"

namespace raystudy::ploc {

/// The clusters of a round in the order of their Morton codes, their boxes in six rows: three of lower and three of negated upper
/// bounds, so that a union is a minimum. Before the first and behind the last stand boxes of all space, which as neighbours are
/// farther than any other: a search need not know where the rows end.
class Clusters {
 public:
  static constexpr std::size_t rows = 6;
  static constexpr std::uint32_t leaf_bit = 0x80000000U;

  /// `most` clusters at a time; `margin`: how far from a cluster its neighbours are read. `room` is the caller's, of
  /// room_for(most, margin) floats.
  Clusters(std::size_t most, std::size_t margin, std::span<float> room)
      : margin_(margin),
        stride_(most + 2 * margin + vector),
        bounds_(room.data()),
        links_(reinterpret_cast<std::uint32_t*>(bounds_ + rows * stride_)) {
    for (std::size_t r = 0; r < rows; ++r) std::fill_n(bounds_ + r * stride_, margin_, -infinity);
    set_count(0);
  }

  [[nodiscard]] static std::size_t room_for(std::size_t most, std::size_t margin) {
    return rows * (most + 2 * margin + vector) + most;
  }

  [[nodiscard]] std::size_t count() const { return count_; }
  /// The first `n` clusters are there.
  void set_count(std::size_t n) {
    count_ = n;
    for (std::size_t r = 0; r < rows; ++r) std::fill_n(row(r) + n, margin_ + vector, -infinity);
  }

  [[nodiscard]] float* row(std::size_t r) { return bounds_ + r * stride_ + margin_; }
  [[nodiscard]] const float* row(std::size_t r) const { return bounds_ + r * stride_ + margin_; }
  /// Of a leaf its place in the order of triangles, with leaf_bit; of an inner node where its children stand.
  [[nodiscard]] std::uint32_t& link(std::size_t i) { return links_[i]; }
  [[nodiscard]] std::uint32_t link(std::size_t i) const { return links_[i]; }

  [[nodiscard]] Box box(std::size_t i) const { return {{row(0)[i], row(1)[i], row(2)[i]}, {-row(3)[i], -row(4)[i], -row(5)[i]}}; }

 private:
  static constexpr float infinity = std::numeric_limits<float>::infinity();
  static constexpr std::size_t vector = HWY_MAX_BYTES / sizeof(float);

  std::size_t margin_;
  std::size_t stride_;
  std::size_t count_ = 0;
  float* bounds_;
  std::uint32_t* links_;
};

}  // namespace raystudy::ploc
