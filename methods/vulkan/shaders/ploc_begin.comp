#version 460
#extension GL_GOOGLE_include_directive : require
#include "methods/vulkan/shaders/ploc.glsl"

// Every triangle is a cluster.
layout(push_constant, scalar) uniform Push {
  Boxes boxes;
  Uints order;
  Boxes clusters;
  Uints links;
  uint count;
} push;

void main() {
  const uint i = invocation_index();
  if (i >= push.count) return;
  push.clusters.at[i] = push.boxes.at[push.order.at[i]];
  push.links.at[i] = leaf_bit | i;
}
