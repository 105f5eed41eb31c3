#version 460
#extension GL_GOOGLE_include_directive : require
#include "methods/vulkan/shaders/ploc.glsl"

// The nearest of the clusters up to `radius` places before and behind each: that whose union with it has the least area; of equal
// ones the j for which i XOR j is least. Areas that are no number count as infinite. (Meister and Bittner 2018, Alg. 1; methods/ploc.)
layout(constant_id = 1) const uint room = 1;  // boxes in shared memory: those of the group, and `radius` before and behind

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
  const int start = int(group_index() * gl_WorkGroupSize.x) - int(push.radius);
  for (uint s = lane; s < gl_WorkGroupSize.x + 2 * push.radius; s += gl_WorkGroupSize.x) {
    const int i = start + int(s);
    if (i < 0 || i >= int(push.count)) continue;
    const Box box = push.clusters.at[i];
    for (uint k = 0; k < 3; ++k) {
      bounds[k * room + s] = box.lower[k];
      bounds[(3 + k) * room + s] = box.upper[k];
    }
  }
  barrier();
  const uint i = invocation_index();
  if (i >= push.count) return;
  const Box own = box_at(lane + push.radius);
  const float infinity = uintBitsToFloat(0x7f800000u);
  const uint first = i - min(i, push.radius);
  const uint last = min(i + push.radius, push.count - 1);
  float least = infinity;
  uint least_xor = ~0u;
  for (uint j = first; j <= last; ++j) {
    if (j == i) continue;
    const Box other = box_at(uint(int(j) - start));
    const vec3 e = max(own.upper, other.upper) - min(own.lower, other.lower);
    precise float area = (e.x * e.y + e.y * e.z) + e.z * e.x;
    if (!(area < infinity)) area = infinity;
    if (area < least || (area == least && (i ^ j) < least_xor)) {
      least = area;
      least_xor = i ^ j;
    }
  }
  push.nearest.at[i] = i ^ least_xor;
}
