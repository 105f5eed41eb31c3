#include "methods/spatial/slicer.h"

namespace raystudy::spatial {
namespace {

/// The part's box with room for errors, inside `bounds`, and with the sign of zeros as BoxRecord::of has it.
WideBox box_of(const Extent& part, hn::Vec<Float4> error, const WideBox& bounds) {
  const auto zero = hn::Zero(Float4());
  const auto lower = hn::Max(hn::Sub(part.lower, error), bounds.lower());
  const auto upper = hn::Min(hn::Add(part.upper, error), hn::Neg(bounds.negated_upper()));
  return WideBox::of(hn::Add(lower, zero), hn::Neg(hn::Add(upper, zero)));
}

}  // namespace

std::array<WideBox, 2> chopped(const Scene& scene, const BoxRecord& record, int axis, float at) {
  const Float4 d;
  const Slicer slicer(Corners(scene, record.triangle), axis);
  const auto from = hn::Set(d, record.lower[axis]);
  const auto plane = hn::Set(d, at);
  const auto to = hn::Set(d, -record.negated_upper[axis]);
  const Extent cut = slicer.cut(plane);
  const WideBox box = WideBox::of(record);
  const auto is_axis = hn::Eq(hn::Iota(d, 0), hn::Set(d, static_cast<float>(axis)));
  const auto lower = hn::IfThenElse(is_axis, plane, box.lower());
  const auto negated_upper = hn::IfThenElse(is_axis, hn::Neg(plane), box.negated_upper());
  return {box_of(slicer.between(from, slicer.cut(from), plane, cut), slicer.error(), WideBox::of(box.lower(), negated_upper)),
          box_of(slicer.between(plane, cut, to, slicer.cut(to)), slicer.error(), WideBox::of(lower, box.negated_upper()))};
}

}  // namespace raystudy::spatial
