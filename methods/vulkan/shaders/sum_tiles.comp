#version 460
#extension GL_GOOGLE_include_directive : require
#include "harness/vulkan/shaders/common.glsl"
#include "methods/vulkan/shaders/workgroup_sum.glsl"

// The sum of each tile of values.
layout(constant_id = 1) const uint items = 1;  // values that an invocation adds up

layout(push_constant, scalar) uniform Push {
  Uints values;
  Uints sums;
  uint count;
} push;

void main() {
  uint sum = 0;
  const uint begin = group_index() * gl_WorkGroupSize.x * items + gl_LocalInvocationID.x;
  for (uint k = 0; k < items; ++k) {
    const uint i = begin + k * gl_WorkGroupSize.x;
    if (i < push.count) sum += push.values.at[i];
  }
  uint total;
  sum_before(sum, total);
  if (gl_LocalInvocationID.x == 0 && begin < push.count) push.sums.at[group_index()] = total;
}
