#version 460
#extension GL_GOOGLE_include_directive : require
#include "harness/vulkan/shaders/common.glsl"
#include "methods/vulkan/shaders/radix.glsl"

// How many keys of each tile have each digit: counts[digit][tile].
layout(push_constant, scalar) uniform Push {
  Uints words;  // those of the keys that have the digit
  Uints counts;
  uint count;
  uint tiles;
  uint tile_items;  // those of the workgroup
  uint shift;
} push;

shared uint counters[digits];

void main() {
  const uint tile = group_index();
  const uint lane = gl_LocalInvocationID.x;
  for (uint d = lane; d < digits; d += gl_WorkGroupSize.x) counters[d] = 0;
  barrier();
  const uint begin = tile * gl_WorkGroupSize.x * items + lane;
  for (uint k = 0; k < items; ++k) {
    const uint i = begin + k * gl_WorkGroupSize.x;
    if (i < push.count) atomicAdd(counters[digit(push.words.at[i], push.shift)], 1);
  }
  barrier();
  if (tile >= push.tiles) return;
  for (uint d = lane; d < digits; d += gl_WorkGroupSize.x) push.counts.at[d * push.tiles + tile] = counters[d];
}
