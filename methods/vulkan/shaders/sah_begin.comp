#version 460
#extension GL_GOOGLE_include_directive : require
#include "methods/vulkan/shaders/scene.glsl"

// Triangles in the order of the scene, and the root as a leaf of them all.
layout(push_constant, scalar) uniform Push {
  Uints bounds;
  Uints indices;
  Nodes nodes;
  uint count;
} push;

void main() {
  const uint i = invocation_index();
  if (i < push.count) push.indices.at[i] = i;
  if (i != 0) return;
  Box box;
  for (uint axis = 0; axis < 3; ++axis) {
    box.lower[axis] = from_sortable(push.bounds.at[axis]);
    box.upper[axis] = from_sortable(push.bounds.at[3 + axis]);
  }
  push.nodes.at[0] = Node(box, 0, push.count);
}
