#version 460
#extension GL_GOOGLE_include_directive : require
#include "methods/vulkan/shaders/scene.glsl"

// From the splits that are kept to the leaves between them: where each leaf begins, and the depth of the split behind it.
layout(push_constant, scalar) uniform Push {
  Uints ranks;  // how many splits before a place are kept; of `count` all
  Uints depths;
  Uints leaf_first;  // one more than there are leaves
  Uints leaf_depth;
  uint count;
} push;

void main() {
  const uint p = invocation_index();
  if (p >= push.count) return;
  const uint rank = push.ranks.at[p];
  if (p == 0) push.leaf_first.at[0] = 0;
  if (p == push.count - 1) push.leaf_first.at[rank + 1] = push.count;
  if (push.ranks.at[p + 1] == rank) return;
  push.leaf_first.at[rank + 1] = p + 1;
  push.leaf_depth.at[rank] = push.depths.at[p];
}
