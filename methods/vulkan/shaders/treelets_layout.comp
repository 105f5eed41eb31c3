#version 460
#extension GL_GOOGLE_include_directive : require
#include "methods/vulkan/shaders/treelets.glsl"

// Nodes and triangles of the treelets to where the tree over them wants them: an invocation has a leaf's triangles, and the nodes
// that the split behind the leaf parts, or, behind a treelet's last leaf, its root.
layout(push_constant, scalar) uniform Push {
  Nodes roots;
  Nodes from;
  Nodes to;
  Uints order;
  Uints triangles;
  Uints leaf_first;
  Uints treelets;  // of each leaf
  Uints treelet_first;
  Places places;
  uint leaves;
} push;

void main() {
  const uint leaf = invocation_index();
  if (leaf >= push.leaves) return;
  const uint t = push.treelets.at[leaf];
  const Place place = push.places.at[t];
  const uint begin = push.treelet_first.at[t];
  const uint leaf_shift = place.leaf - begin;
  const uint triangle_shift = place.triangle - push.leaf_first.at[begin];
  for (uint i = push.leaf_first.at[leaf]; i < push.leaf_first.at[leaf + 1]; ++i) push.triangles.at[i + triangle_shift] = push.order.at[i];
  const bool root = leaf + 1 == push.treelet_first.at[t + 1];
  for (uint side = 0; side < (root ? 1 : 2); ++side) {
    Node node;
    if (root) {
      node = push.roots.at[t];
    } else {
      node = push.from.at[2 * leaf + 2 + side];
    }
    node.first += node.count == 0 ? 2 * leaf_shift : triangle_shift;
    push.to.at[root ? place.slot : 2 * (leaf + leaf_shift) + 2 + side] = node;
  }
}
