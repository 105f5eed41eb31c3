#version 460
#extension GL_GOOGLE_include_directive : require
#include "methods/vulkan/shaders/scene.glsl"
#include "methods/vulkan/shaders/places.glsl"

// From the places behind which leaves are parted to the leaves: where each begins, and the depth of the split behind it.
layout(push_constant, scalar) uniform Push {
  Uints masks;
  Uints ranks;  // how many leaves end before the places of a mask
  Uints depths;
  Uints leaf_first;  // one more than there are leaves
  Uints leaf_depth;
  uint count;
} push;

void main() {
  const uint group = invocation_index();
  const uint begin = group * places;
  if (begin >= push.count) return;
  uint mask = push.masks.at[group];
  uint rank = push.ranks.at[group];
  if (group == 0) push.leaf_first.at[0] = 0;
  while (mask != 0) {
    const uint p = begin + findLSB(mask);
    mask &= mask - 1;
    push.leaf_depth.at[rank] = push.depths.at[p];
    ++rank;
    push.leaf_first.at[rank] = p + 1;
  }
  if (begin + places >= push.count) push.leaf_first.at[rank + 1] = push.count;
}
