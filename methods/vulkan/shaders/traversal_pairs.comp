#version 460
#extension GL_GOOGLE_include_directive : require
#include "methods/vulkan/shaders/traversal.glsl"

// Puts every node into its half of a pair, and marks the last triangle of every leaf.
layout(push_constant, scalar) uniform Push {
  Nodes nodes;
  Uints pairs;
  Uints leaf_triangles;
  uint count;
} push;

void main() {
  const uint i = invocation_index();
  if (i >= push.count || i == 1) return;  // what is beside the root is no node
  const Node node = push.nodes.at[i];
  const uint to = i / 2 * pair_floats + i % 2;
  for (uint axis = 0; axis < 3; ++axis) {
    push.pairs.at[to + 4 * axis] = floatBitsToUint(node.box.lower[axis]);
    push.pairs.at[to + 4 * axis + 2] = floatBitsToUint(node.box.upper[axis]);
  }
  const bool leaf = node.count > 0;
  push.pairs.at[to + pair_references] = leaf ? node.first | leaf_bit : node.first / 2;
  if (leaf) push.leaf_triangles.at[(node.first + node.count - 1) * triangle_words + triangle_number] |= last_bit;
}
