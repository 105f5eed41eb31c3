#version 460
#extension GL_GOOGLE_include_directive : require
#include "methods/vulkan/shaders/refit.glsl"

// The nodes of one level, whose children are done.
layout(push_constant, scalar) uniform Push {
  Nodes nodes;
  Vertices vertices;
  Triangles corners;
  Uints level;
  uint count;
} push;

void main() {
  const uint i = invocation_index();
  if (i >= push.count) return;
  const uint n = push.level.at[i];
  const uint first = push.nodes.at[n].first;
  const uint count = push.nodes.at[n].count;
  Box box;
  if (count > 0) {
    box = leaf_box(push.vertices, push.corners, first, count);
  } else {
    box = united(push.nodes.at[first].box, push.nodes.at[first + 1].box);
  }
  push.nodes.at[n].box = box;
}
