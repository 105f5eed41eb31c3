#version 460
#extension GL_GOOGLE_include_directive : require
#include "methods/vulkan/shaders/scene.glsl"

// Positions between two key frames, operation by operation as positions_at of harness/scene/animation.h.
layout(push_constant, scalar) uniform Push {
  Vertices before;
  Vertices after;
  Vertices to;
  uint count;
  float share;
} push;

void main() {
  const uint i = invocation_index();
  if (i >= push.count) return;
  const vec3 from = push.before.at[i];
  const precise vec3 position = from + (push.after.at[i] - from) * push.share;
  push.to.at[i] = position;
}
