#version 460
#extension GL_GOOGLE_include_directive : require
#include "harness/vulkan/shaders/common.glsl"
#include "methods/vulkan/shaders/sah_queue.glsl"

// The children of a level, without gaps and small ones: the nodes to be split on the next.
layout(push_constant, scalar) uniform Push {
  Uints children;
  Uints places;  // prefix sums of the flags
  Uints to;
  uint count;
} push;

void main() {
  const uint i = invocation_index();
  if (i >= push.count) return;
  const uint child = push.children.at[i];
  if (child < no_child) push.to.at[push.places.at[i]] = child;
}
