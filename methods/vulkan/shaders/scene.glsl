// Scenes and trees as kernels see them.
#include "harness/vulkan/shaders/common.glsl"

struct Box {
  vec3 lower;
  vec3 upper;
};

// Bvh2Node of harness/accel/bvh2.h.
struct Node {
  Box box;
  uint first;
  uint count;  // of a leaf's triangles; 0: an inner node
};

layout(buffer_reference, scalar, buffer_reference_align = 4) buffer Vertices { vec3 at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer Triangles { uvec3 at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 8) buffer Boxes { Box at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 32) buffer Nodes { Node at[]; };

Box empty_box() { return Box(vec3(uintBitsToFloat(0x7f800000u)), vec3(uintBitsToFloat(0xff800000u))); }
// Of bounds that are equal, zeros of either sign, those of `a`: as Box::extend does it.
Box united(Box a, Box b) { return Box(mix(a.lower, b.lower, lessThan(b.lower, a.lower)), mix(a.upper, b.upper, lessThan(a.upper, b.upper))); }

// Unsigned numbers in the order of the floats they stand for, and back.
uint sortable(float x) {
  const uint bits = floatBitsToUint(x);
  return (bits & 0x80000000u) != 0 ? ~bits : bits | 0x80000000u;
}
float from_sortable(uint s) { return uintBitsToFloat((s & 0x80000000u) != 0 ? s & 0x7fffffffu : ~s); }
