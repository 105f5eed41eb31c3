#version 460
#extension GL_GOOGLE_include_directive : require
#include "methods/vulkan/shaders/traversal.glsl"

// The corners of each triangle, in the order of the leaves.
layout(push_constant, scalar) uniform Push {
  Vertices vertices;
  Triangles triangles;
  Uints order;
  Uints leaf_triangles;
  uint count;
} push;

void main() {
  const uint i = invocation_index();
  if (i >= push.count) return;
  const uint number = push.order.at[i];
  const uvec3 corners = push.triangles.at[number];
  const uint to = i * triangle_words;
  for (uint k = 0; k < 3; ++k) {
    const vec3 p = push.vertices.at[corners[k]];
    for (uint axis = 0; axis < 3; ++axis) push.leaf_triangles.at[to + 3 * k + axis] = floatBitsToUint(p[axis]);
  }
  push.leaf_triangles.at[to + triangle_number] = number;
}
