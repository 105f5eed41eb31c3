#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "methods/vulkan/shaders/ploc.glsl"

// The nearest of the clusters up to `radius` places before and behind each: that whose union with it has the least area; of equal
// ones the j for which i XOR j is least. Areas that are no number count as infinite. (Meister and Bittner 2018, Alg. 1; methods/ploc.)
// An invocation has some clusters that stand together, and looks at each neighbour once for all of them.
layout(constant_id = 1) const uint room = 1;  // boxes in shared memory: those of the group, and `radius` before and behind
layout(constant_id = 2) const uint own = 1;   // clusters of an invocation

layout(push_constant, scalar) uniform Push {
  Boxes clusters;
  Uints nearest;
  uint count;
  uint radius;
} push;

shared float bounds[6 * room];

Box box_at(uint s) {
  return Box(vec3(bounds[s], bounds[room + s], bounds[2 * room + s]), vec3(bounds[3 * room + s], bounds[4 * room + s], bounds[5 * room + s]));
}

void main() {
  const uint lane = gl_LocalInvocationID.x;
  const uint group_clusters = gl_WorkGroupSize.x * own;
  const int start = int(group_index() * group_clusters) - int(push.radius);
  for (uint s = lane; s < group_clusters + 2 * push.radius; s += gl_WorkGroupSize.x) {
    const int i = start + int(s);
    if (i < 0 || i >= int(push.count)) continue;
    const Box box = push.clusters.at[i];
    for (uint k = 0; k < 3; ++k) {
      bounds[k * room + s] = box.lower[k];
      bounds[(3 + k) * room + s] = box.upper[k];
    }
  }
  barrier();
  const uint begin = invocation_index() * own;
  if (begin >= push.count) return;
  const float infinity = uintBitsToFloat(0x7f800000u);
  Box boxes[own];
  float least[own];
  uint least_xor[own];
  [[unroll]] for (uint c = 0; c < own; ++c) {
    boxes[c] = box_at(lane * own + c + push.radius);
    least[c] = infinity;
    least_xor[c] = ~0u;
  }
  const uint first = begin - min(begin, push.radius);
  const uint last = min(begin + own - 1 + push.radius, push.count - 1);
  for (uint j = first; j <= last; ++j) {
    const Box other = box_at(uint(int(j) - start));
    [[unroll]] for (uint c = 0; c < own; ++c) {
      const uint i = begin + c;
      const vec3 e = max(boxes[c].upper, other.upper) - min(boxes[c].lower, other.lower);
      precise float area = (e.x * e.y + e.y * e.z) + e.z * e.x;
      if (!(area < infinity)) area = infinity;
      const bool near = j != i && j + push.radius >= i && j <= i + push.radius;
      if (near && (area < least[c] || (area == least[c] && (i ^ j) < least_xor[c]))) {
        least[c] = area;
        least_xor[c] = i ^ j;
      }
    }
  }
  [[unroll]] for (uint c = 0; c < own; ++c) {
    const uint i = begin + c;
    if (i < push.count) push.nearest.at[i] = i ^ least_xor[c];
  }
}
