#version 460
#extension GL_GOOGLE_include_directive : require
#include "methods/vulkan/shaders/sah.glsl"
#include "methods/vulkan/shaders/sah_segments.glsl"

// Marks the triangles of a large node that go left, for the prefix sum that says where.
layout(push_constant, scalar) uniform Push {
  Boxes boxes;
  Uints indices;
  Uints flags;
  Results result;
  uint begin;
  uint count;
} push;

void main() {
  const uint i = invocation_index();
  if (i >= push.count) return;
  const Result r = push.result.at[0];
  bool left = i < r.lefts;
  if (r.axis != no_axis) {
    const uint triangle = push.indices.at[push.begin + i];
    left = goes_left(along(box_center(push.boxes.at[triangle]), r.axis), triangle, r.position, r.index);
  }
  push.flags.at[push.begin + i] = left ? 1 : 0;
}
