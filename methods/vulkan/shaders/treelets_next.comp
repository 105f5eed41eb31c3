#version 460
#extension GL_GOOGLE_include_directive : require
#include "methods/vulkan/shaders/treelets.glsl"

// One invocation, between two levels: how many workgroups the next one gets; the queue of the last is empty again.
layout(push_constant, scalar) uniform Push {
  Queues queues;
  uint next;
} push;

void main() {
  if (invocation_index() != 0) return;
  push.queues.at[push.next].groups = uvec3(min(push.queues.at[push.next].count, 65535), 1, 1);
  push.queues.at[1 - push.next].count = 0;
}
