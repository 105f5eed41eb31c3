#version 460
#extension GL_GOOGLE_include_directive : require
#include "methods/vulkan/shaders/scene.glsl"

// 1 for each place behind which leaves are parted, 0 for all others: where a node of more than max_leaf triangles is split, and
// where the split is less deep than least_depth. A node's range ends, to either side, before the first split that is less deep
// than its own. With max_leaf 0 nodes do not count.
layout(constant_id = 1) const uint max_leaf = 1;
layout(constant_id = 2) const uint least_depth = 0;

layout(push_constant, scalar) uniform Push {
  Uints depths;
  Uints kept;
  uint count;
} push;

void main() {
  const uint p = invocation_index();
  if (p >= push.count) return;
  if (p == push.count - 1) {
    push.kept.at[p] = 0;
    return;
  }
  const uint depth = push.depths.at[p];
  bool kept = depth < least_depth;
  if (!kept && max_leaf > 0) {
    uint size = 2;
    for (uint i = p; i > 0 && size <= max_leaf && push.depths.at[i - 1] > depth; --i) ++size;
    for (uint i = p + 1; i < push.count - 1 && size <= max_leaf && push.depths.at[i] > depth; ++i) ++size;
    kept = size > max_leaf;
  }
  push.kept.at[p] = kept ? 1 : 0;
}
