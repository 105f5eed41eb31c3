#version 460
#extension GL_GOOGLE_include_directive : require
#include "methods/vulkan/shaders/scene.glsl"
#include "methods/vulkan/shaders/lbvh.glsl"
#include "methods/vulkan/shaders/leaf.glsl"

// Hierarchy and boxes in one pass from the leaves up (Apetrei 2014): the parent of a range of leaves is split at the deeper of the
// two splits beside it. Of the invocations that come up to a node the first leaves where its range ends and stops, the second goes
// on with the node.
layout(constant_id = 3) const uint least_depth = 0;  // splits less deep are those between treelets
layout(constant_id = 4) const bool fences = true;  // device_shape.h

layout(buffer_reference, scalar, buffer_reference_align = 32) coherent buffer SharedNodes { Node at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) coherent buffer Ends { uint at[]; };

layout(push_constant, scalar) uniform Push {
  Boxes boxes;
  Uints order;
  Uints leaf_first;
  Uints depths;
  SharedNodes nodes;
  Ends ends;         // of each split, begun as ~0
  SharedNodes roots; // of treelets
  Uints treelets;    // of each leaf
  uint leaves;
} push;

// Depths of the splits before a leaf and behind one; -1 where the tree ends.
int depth_of(uint split) {
  const int depth = int(push.depths.at[split]);
  return depth < int(least_depth) ? -1 : depth;
}
int depth_before(uint leaf) { return leaf > 0 ? depth_of(leaf - 1) : -1; }
int depth_behind(uint leaf) { return leaf + 1 < push.leaves ? depth_of(leaf) : -1; }

void main() {
  const uint leaf = invocation_index();
  if (leaf >= push.leaves) return;
  uint first = leaf;
  uint last = leaf;
  Node node = leaf_node(push.boxes, push.order, push.leaf_first, leaf);
  int before = depth_before(first);
  int behind = depth_behind(last);
  while (before >= 0 || behind >= 0) {
    const bool left = behind > before;
    const uint split = left ? last : first - 1;
    const uint slot = left ? left_slot(last) : right_slot(first);
    push.nodes.at[slot] = node;
    if (fences) memoryBarrierBuffer();
    const uint end = atomicExchange(push.ends.at[split], left ? first : last);
    if (end == ~0u) return;
    if (fences) memoryBarrierBuffer();
    const Box sibling = push.nodes.at[slot ^ 1].box;
    if (left) {
      last = end;
      behind = depth_behind(last);
      node.box = united(node.box, sibling);
    } else {
      first = end;
      before = depth_before(first);
      node.box = united(sibling, node.box);
    }
    node.first = children_of(split);
    node.count = 0;
  }
  if (least_depth == 0) {
    push.nodes.at[0] = node;
  } else {
    push.roots.at[push.treelets.at[leaf]] = node;
  }
}
