#pragma once

#include <hwy/highway.h>

#include <cstddef>
#include <cstdint>
#include <limits>

#include "harness/base/aligned.h"
#include "harness/geometry/box.h"

namespace raystudy::topdown {

namespace hn = hwy::HWY_NAMESPACE;
using Float4 = hn::FixedTag<float, 4>;
using Int4 = hn::FixedTag<std::int32_t, 4>;

/// A triangle's box in two 16-byte halves, so that a vector register takes each with one load. The fourth lane of a half holds no
/// coordinate; nothing is ever computed from it.
struct alignas(32) BoxRecord {
  float lower[3];
  std::uint32_t triangle;  ///< index into Scene::triangles
  float upper[3];
  std::uint32_t rank;  ///< scratch of the builder
};
static_assert(sizeof(BoxRecord) == 32);

/// Room for records, not written to before they are.
class BoxRecords {
 public:
  explicit BoxRecords(std::size_t n) : size_(n), data_(AlignedAllocator<BoxRecord>().allocate(n)) {}
  BoxRecords(const BoxRecords&) = delete;
  BoxRecords& operator=(const BoxRecords&) = delete;
  ~BoxRecords() { AlignedAllocator<BoxRecord>().deallocate(data_, size_); }

  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] BoxRecord* data() { return data_; }
  [[nodiscard]] BoxRecord& operator[](std::size_t i) { return data_[i]; }
  [[nodiscard]] const BoxRecord& operator[](std::size_t i) const { return data_[i]; }

 private:
  std::size_t size_;
  BoxRecord* data_;
};

/// A box in two vector registers; the fourth lanes are meaningless.
struct WideBox {
  hn::Vec<Float4> lower;
  hn::Vec<Float4> upper;

  [[nodiscard]] static WideBox of(const BoxRecord& record) {
    const auto* p = reinterpret_cast<const float*>(&record);
    return {hn::Load(Float4(), p), hn::Load(Float4(), p + 4)};
  }
  [[nodiscard]] static WideBox empty() {
    constexpr float inf = std::numeric_limits<float>::infinity();
    return {hn::Set(Float4(), inf), hn::Set(Float4(), -inf)};
  }
  [[nodiscard]] Box box() const {
    alignas(16) float l[4];
    alignas(16) float u[4];
    hn::Store(lower, Float4(), l);
    hn::Store(upper, Float4(), u);
    return {{l[0], l[1], l[2]}, {u[0], u[1], u[2]}};
  }
};

[[nodiscard]] inline WideBox united(const WideBox& a, const WideBox& b) {
  return {hn::Min(a.lower, b.lower), hn::Max(a.upper, b.upper)};
}

/// Box::half_area of four boxes, bit for bit.
[[nodiscard]] inline hn::Vec<Float4> half_areas(const WideBox& b0, const WideBox& b1, const WideBox& b2, const WideBox& b3) {
  const Float4 d;
  const auto e0 = hn::Sub(b0.upper, b0.lower);
  const auto e1 = hn::Sub(b1.upper, b1.lower);
  const auto e2 = hn::Sub(b2.upper, b2.lower);
  const auto e3 = hn::Sub(b3.upper, b3.lower);
  // A transpose, so that the products are of four boxes at once: x0 x1 y0 y1, x2 x3 y2 y3, z0 z1 ..., z2 z3 ...
  const auto xy01 = hn::InterleaveLower(d, e0, e1);
  const auto xy23 = hn::InterleaveLower(d, e2, e3);
  const auto z01 = hn::InterleaveUpper(d, e0, e1);
  const auto z23 = hn::InterleaveUpper(d, e2, e3);
  const auto x = hn::ConcatLowerLower(d, xy23, xy01);
  const auto y = hn::ConcatUpperUpper(d, xy23, xy01);
  const auto z = hn::ConcatLowerLower(d, z23, z01);
  return hn::Add(hn::Add(hn::Mul(x, y), hn::Mul(y, z)), hn::Mul(z, x));
}

/// Grows `acc` by four boxes one after another and returns the half areas of the four states on the way: of the first in lane 0,
/// or with `reversed` of the first in lane 3.
template <bool reversed>
[[nodiscard]] inline hn::Vec<Float4> grow(WideBox& acc, const WideBox& b0, const WideBox& b1, const WideBox& b2,
                                          const WideBox& b3) {
  // Two boxes are united apart from `acc`: the chain of dependent instructions is then two a step instead of four.
  const WideBox s0 = united(acc, b0);
  const WideBox s1 = united(acc, united(b0, b1));
  const WideBox s2 = united(s1, b2);
  const WideBox s3 = united(s1, united(b2, b3));
  // Half by half: copied whole, the box would take a detour through memory, a wide load after two narrow stores.
  acc.lower = s3.lower;
  acc.upper = s3.upper;
  return reversed ? half_areas(s3, s2, s1, s0) : half_areas(s0, s1, s2, s3);
}

}  // namespace raystudy::topdown
