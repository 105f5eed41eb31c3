#version 460
#extension GL_GOOGLE_include_directive : require
#include "harness/vulkan/shaders/common.glsl"
#include "methods/vulkan/shaders/workgroup_sum.glsl"

// One workgroup: in place of each tile's sum that of the tiles before it; the sum of all goes to `total`.
layout(push_constant, scalar) uniform Push {
  Uints sums;
  Uints total;
  uint tiles;
} push;

void main() {
  uint before = 0;
  for (uint begin = 0; begin < push.tiles; begin += gl_WorkGroupSize.x) {
    const uint i = begin + gl_LocalInvocationID.x;
    uint total;
    const uint sum = sum_before(i < push.tiles ? push.sums.at[i] : 0, total);
    if (i < push.tiles) push.sums.at[i] = before + sum;
    before += total;
  }
  if (gl_LocalInvocationID.x == 0) push.total.at[0] = before;
}
