#version 460
#extension GL_GOOGLE_include_directive : require
#include "methods/vulkan/shaders/sah.glsl"
#include "methods/vulkan/shaders/sah_segments.glsl"

// The bounds of the centers of a large node, one workgroup a segment.
layout(push_constant, scalar) uniform Push {
  Boxes boxes;
  Uints indices;
  Minima minima;
  Maxima maxima;
  uint begin;
  uint count;
} push;

shared uint lowest[3];
shared uint highest[3];

void main() {
  const uint lane = gl_LocalInvocationID.x;
  const uvec2 range = segment_range(group_index(), push.count);
  if (range.x >= push.count) return;
  for (uint axis = lane; axis < 3; axis += gl_WorkGroupSize.x) {
    lowest[axis] = ~0u;
    highest[axis] = 0;
  }
  barrier();
  vec3 lower = vec3(infinity);
  vec3 upper = vec3(-infinity);
  for (uint i = range.x + lane; i < range.y; i += gl_WorkGroupSize.x) {
    const vec3 center = box_center(push.boxes.at[push.indices.at[push.begin + i]]);
    lower = min(lower, center);
    upper = max(upper, center);
  }
  for (uint axis = 0; axis < 3; ++axis) {
    atomicMin(lowest[axis], sortable(lower[axis]));
    atomicMax(highest[axis], sortable(upper[axis]));
  }
  barrier();
  for (uint axis = lane; axis < 3; axis += gl_WorkGroupSize.x) {
    atomicMin(push.minima.center[axis], lowest[axis]);
    atomicMax(push.maxima.center[axis], highest[axis]);
  }
}
