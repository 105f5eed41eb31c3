#version 460
#extension GL_GOOGLE_include_directive : require
#include "harness/vulkan/shaders/common.glsl"

// Writes first, first + 1, ...: what the tests of the device layer run.
layout(push_constant, scalar) uniform Push {
  Uints to;
  uint count;
  uint first;
} push;

void main() {
  const uint i = invocation_index();
  if (i < push.count) push.to.at[i] = push.first + i;
}
