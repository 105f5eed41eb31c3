#version 460
#extension GL_GOOGLE_include_directive : require
#include "methods/vulkan/shaders/scene.glsl"

// Nodes over cells: the boxes of what the host has laid out.
struct TopNode {
  uint node;
  uint first_cell;
  uint end_cell;
  uint first;  // as in Node
  uint count;
};
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer TopNodes { TopNode at[]; };

layout(push_constant, scalar) uniform Push {
  TopNodes top;
  Uints minima;
  Uints maxima;
  Nodes nodes;
  uint count;
} push;

void main() {
  const uint i = invocation_index();
  if (i >= push.count) return;
  const TopNode node = push.top.at[i];
  uvec3 lower = uvec3(~0u);
  uvec3 upper = uvec3(0);
  for (uint cell = node.first_cell; cell < node.end_cell; ++cell) {
    for (uint axis = 0; axis < 3; ++axis) {
      lower[axis] = min(lower[axis], push.minima.at[3 * cell + axis]);
      upper[axis] = max(upper[axis], push.maxima.at[3 * cell + axis]);
    }
  }
  Box box;
  for (uint axis = 0; axis < 3; ++axis) {
    box.lower[axis] = from_sortable(lower[axis]);
    box.upper[axis] = from_sortable(upper[axis]);
  }
  push.nodes.at[node.node] = Node(box, node.first, node.count);
}
