#version 460
#extension GL_GOOGLE_include_directive : require
#include "methods/vulkan/shaders/sah.glsl"
#include "methods/vulkan/shaders/sah_segments.glsl"

// Brings the indices of a large node's triangles into the order of its children, equal ones in their order.
layout(push_constant, scalar) uniform Push {
  Uints indices;
  Uints sums;  // of the flags
  Uints to;
  Results result;
  uint begin;
  uint count;
} push;

void main() {
  const uint i = invocation_index();
  if (i >= push.count) return;
  const uint sum = push.sums.at[push.begin + i];
  const uint before = sum - push.sums.at[push.begin];
  const bool left = push.sums.at[push.begin + i + 1] != sum;
  const uint place = left ? before : push.result.at[0].lefts + i - before;
  push.to.at[push.begin + place] = push.indices.at[push.begin + i];
}
