#version 460
#extension GL_GOOGLE_include_directive : require
#include "methods/vulkan/shaders/scene.glsl"

// 1 for each leaf behind which a treelet ends: where the split is less deep than least_depth; 0 for all others.
layout(push_constant, scalar) uniform Push {
  Uints depths;
  Uints flags;
  uint count;
  uint least_depth;
} push;

void main() {
  const uint i = invocation_index();
  if (i < push.count) push.flags.at[i] = i + 1 < push.count && push.depths.at[i] < push.least_depth ? 1 : 0;
}
