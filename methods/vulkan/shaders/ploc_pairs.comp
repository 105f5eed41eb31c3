#version 460
#extension GL_GOOGLE_include_directive : require
#include "methods/vulkan/shaders/ploc.glsl"

// Two that are each other's nearest are merged, in the place of the first: 1 for each cluster that stays, `count` words, then 1 for
// each that is merged with one behind it.
layout(push_constant, scalar) uniform Push {
  Uints nearest;
  Uints marks;
  uint count;
} push;

void main() {
  const uint i = invocation_index();
  if (i >= push.count) return;
  const uint j = push.nearest.at[i];
  const bool merged = push.nearest.at[j] == i;
  push.marks.at[i] = merged && j < i ? 0 : 1;
  push.marks.at[push.count + i] = merged && i < j ? 1 : 0;
}
