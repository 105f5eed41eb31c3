#version 460
#extension GL_GOOGLE_include_directive : require
#include "methods/vulkan/shaders/scene.glsl"
#include "methods/vulkan/shaders/lbvh.glsl"
#include "methods/vulkan/shaders/leaf.glsl"

// Leaves, and the boxes above them, from the leaves up (Karras 2012): of the two invocations that come up to a node the first stops,
// the second unites the children's boxes.
layout(constant_id = 4) const bool fences = true;  // device_shape.h

layout(buffer_reference, scalar, buffer_reference_align = 32) coherent buffer SharedNodes { Node at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) coherent buffer Arrivals { uint at[]; };

layout(push_constant, scalar) uniform Push {
  Boxes boxes;
  Uints order;
  Uints leaf_first;
  Uints depths;
  Uints slots;
  SharedNodes nodes;
  Arrivals arrivals;  // of each split, begun as ~0
  uint leaves;
} push;

void main() {
  const uint leaf = invocation_index();
  if (leaf >= push.leaves) return;
  const Node node = leaf_node(push.boxes, push.order, push.leaf_first, leaf);
  uint slot = 0;
  if (push.leaves > 1) {
    const bool last = leaf + 1 == push.leaves;
    const bool left = leaf == 0 || (!last && push.depths.at[leaf] > push.depths.at[leaf - 1]);
    slot = left ? left_slot(leaf) : right_slot(leaf);
  }
  push.nodes.at[slot] = node;
  Box box = node.box;
  bool climbs = slot != 0;
  while (climbs) {
    if (fences) memoryBarrierBuffer();
    const uint split = slot / 2 - 1;
    climbs = atomicExchange(push.arrivals.at[split], 0) == 0;
    if (climbs) {
      if (fences) memoryBarrierBuffer();
      const Box sibling = push.nodes.at[slot ^ 1].box;
      box = (slot & 1) == 0 ? united(box, sibling) : united(sibling, box);
      slot = push.slots.at[split];
      push.nodes.at[slot].box = box;
      climbs = slot != 0;
    }
  }
}
