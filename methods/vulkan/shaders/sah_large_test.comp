#version 460
#extension GL_GOOGLE_include_directive : require
#include "methods/vulkan/shaders/sah.glsl"
#include "methods/vulkan/shaders/sah_segments.glsl"
#include "methods/vulkan/shaders/sah_tiles.glsl"

// Shows the triangles of a segment of a large node to every candidate, one workgroup a segment.
layout(push_constant, scalar) uniform Push {
  Boxes boxes;
  Uints indices;
  Minima minima;
  Maxima maxima;
  uint begin;
  uint count;
  float spacing;
} push;

void extend(uint candidate, uint side, Box box) {
  for (uint axis = 0; axis < 3; ++axis) {
    atomicMin(push.minima.at[6 * candidate + 3 * side + axis], sortable(box.lower[axis]));
    atomicMax(push.maxima.at[7 * candidate + 3 * side + axis], sortable(box.upper[axis]));
  }
}

void main() {
  const uvec2 range = segment_range(group_index(), push.count);
  if (range.x >= push.count) return;
  vec3 lower;
  vec3 upper;
  for (uint axis = 0; axis < 3; ++axis) {
    lower[axis] = from_sortable(push.minima.center[axis]);
    upper[axis] = from_sortable(push.maxima.center[axis]);
  }
  for (uint k = 0; k < own; ++k) set_sample(k, number_of(k), lower, upper, push.spacing);
  test_tiles(push.boxes, push.indices, push.begin + range.x, range.y - range.x, false);
  for (uint k = 0; k < own; ++k) {
    const uint number = number_of(k);
    const Candidate c = candidates[k];
    if (c.axis == no_axis) continue;
    atomicAdd(push.maxima.at[7 * number + 6], c.lefts);
    if (c.lefts > 0) extend(number, 0, c.left);
    if (c.lefts < range.y - range.x) extend(number, 1, c.right);
    if (number == 0) {
      const Box box = Box(min(c.left.lower, c.right.lower), max(c.left.upper, c.right.upper));
      extend(3 * samples, range.x < push.count / 2 ? 0 : 1, box);
    }
  }
}
