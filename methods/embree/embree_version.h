#pragma once

/// What differs between Embree 3.13 and Embree 4, in one place: the headers' folder, where the flags of a query go (a context
/// before the ray in 3, optional arguments after it in 4), and ray streams, which 4 has no longer.

#if RAYSTUDY_EMBREE_MAJOR >= 4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

namespace raystudy::embree {

#if RAYSTUDY_EMBREE_MAJOR >= 4
#define RAYSTUDY_EMBREE_STREAMS 0
#else
#define RAYSTUDY_EMBREE_STREAMS 1
#endif

/// The flags of a call of rtcIntersect* or rtcOccluded*.
class QueryFlags {
 public:
#if RAYSTUDY_EMBREE_MAJOR >= 4
  explicit QueryFlags(bool coherent) {
    rtcInitIntersectArguments(&intersect_);
    rtcInitOccludedArguments(&occluded_);
    intersect_.flags = coherent ? RTC_RAY_QUERY_FLAG_COHERENT : RTC_RAY_QUERY_FLAG_INCOHERENT;
    occluded_.flags = intersect_.flags;
    // Only what the scenes hold, so that Embree takes no care of curves, instances or filters.
    intersect_.feature_mask = RTC_FEATURE_FLAG_TRIANGLE;
    occluded_.feature_mask = RTC_FEATURE_FLAG_TRIANGLE;
  }
  void intersect(RTCScene scene, const int*, RTCRayHit& r) { rtcIntersect1(scene, &r, &intersect_); }
  void intersect(RTCScene scene, const int* valid, RTCRayHit8& r) { rtcIntersect8(valid, scene, &r, &intersect_); }
  void intersect(RTCScene scene, const int* valid, RTCRayHit16& r) { rtcIntersect16(valid, scene, &r, &intersect_); }
  void occluded(RTCScene scene, const int*, RTCRay& r) { rtcOccluded1(scene, &r, &occluded_); }
  void occluded(RTCScene scene, const int* valid, RTCRay8& r) { rtcOccluded8(valid, scene, &r, &occluded_); }
  void occluded(RTCScene scene, const int* valid, RTCRay16& r) { rtcOccluded16(valid, scene, &r, &occluded_); }

 private:
  RTCIntersectArguments intersect_;
  RTCOccludedArguments occluded_;
#else
  explicit QueryFlags(bool coherent) {
    rtcInitIntersectContext(&context_);
    context_.flags = coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
  }
  void intersect(RTCScene scene, const int*, RTCRayHit& r) { rtcIntersect1(scene, &context_, &r); }
  void intersect(RTCScene scene, const int* valid, RTCRayHit8& r) { rtcIntersect8(valid, scene, &context_, &r); }
  void intersect(RTCScene scene, const int* valid, RTCRayHit16& r) { rtcIntersect16(valid, scene, &context_, &r); }
  void occluded(RTCScene scene, const int*, RTCRay& r) { rtcOccluded1(scene, &context_, &r); }
  void occluded(RTCScene scene, const int* valid, RTCRay8& r) { rtcOccluded8(valid, scene, &context_, &r); }
  void occluded(RTCScene scene, const int* valid, RTCRay16& r) { rtcOccluded16(valid, scene, &context_, &r); }
  void intersect(RTCScene scene, const RTCRayHitNp& r, unsigned count) { rtcIntersectNp(scene, &context_, &r, count); }
  void occluded(RTCScene scene, const RTCRayNp& r, unsigned count) { rtcOccludedNp(scene, &context_, &r, count); }

 private:
  RTCIntersectContext context_;
#endif
};

}  // namespace raystudy::embree
