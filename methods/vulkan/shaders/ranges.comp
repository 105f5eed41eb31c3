#version 460
#extension GL_GOOGLE_include_directive : require
#include "methods/vulkan/shaders/scene.glsl"

// Of things in a row, parted into ranges behind some of them: where each range begins, and the depth of the split behind it.
layout(push_constant, scalar) uniform Push {
  Uints ranks;  // how many ranges end before a thing; of `count` all but the last
  Uints depths;
  Uints first;  // one more than there are ranges
  Uints first_depths;
  uint count;
} push;

void main() {
  const uint i = invocation_index();
  if (i >= push.count) return;
  const uint rank = push.ranks.at[i];
  if (i == 0) push.first.at[0] = 0;
  if (i == push.count - 1) push.first.at[rank + 1] = push.count;
  if (push.ranks.at[i + 1] == rank) return;
  push.first.at[rank + 1] = i + 1;
  push.first_depths.at[rank] = push.depths.at[i];
}
