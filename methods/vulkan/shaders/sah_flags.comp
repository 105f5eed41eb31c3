#version 460
#extension GL_GOOGLE_include_directive : require
#include "harness/vulkan/shaders/common.glsl"
#include "methods/vulkan/shaders/sah_queue.glsl"

// Marks the children that stay in the main queue, for the prefix sum that says where, and moves small ones to a queue of their
// own, which grows down from the end of the same memory. Their order is by chance: where a node's children go does not depend on it.
layout(push_constant, scalar) uniform Push {
  Uints children;
  Uints flags;
  Uints queue;
  Uints small_count;  // how many small ones there are
  uint count;
  uint capacity;  // of the queue
} push;

void main() {
  const uint i = invocation_index();
  if (i >= push.count) return;
  const uint child = push.children.at[i];
  push.flags.at[i] = child < no_child ? 1 : 0;
  if ((child & is_small) == 0) return;
  const uint place = atomicAdd(push.small_count.at[0], 1);
  push.queue.at[push.capacity - 1 - place] = child & ~is_small;
}
