#version 460
#extension GL_GOOGLE_include_directive : require
#include "harness/vulkan/shaders/common.glsl"
#include "methods/vulkan/shaders/workgroup_sum.glsl"

// In place of each value the sum of those before it, from the sum before its tile. An invocation's values stand together.
layout(constant_id = 1) const uint items = 1;

layout(push_constant, scalar) uniform Push {
  Uints values;
  Uints sums;
  uint count;
} push;

void main() {
  const uint begin = min(invocation_index() * items, push.count);
  const uint end = min(begin + items, push.count);
  uint sum = 0;
  for (uint i = begin; i < end; ++i) sum += push.values.at[i];
  uint total;
  const uint before = sum_before(sum, total);
  if (begin == end) return;
  sum = push.sums.at[group_index()] + before;
  for (uint i = begin; i < end; ++i) {
    const uint value = push.values.at[i];
    push.values.at[i] = sum;
    sum += value;
  }
}
