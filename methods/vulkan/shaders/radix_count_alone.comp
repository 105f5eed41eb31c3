#version 460
#extension GL_GOOGLE_include_directive : require
#include "harness/vulkan/shaders/common.glsl"
#include "methods/vulkan/shaders/radix.glsl"

// radix_count.comp for processors: an invocation is a tile, and counts in memory. The counts begin as 0.
layout(push_constant, scalar) uniform Push {
  Uints words;
  Uints counts;
  uint count;
  uint tiles;
  uint tile_items;
  uint shift;
} push;

void main() {
  const uint tile = invocation_index();
  if (tile >= push.tiles) return;
  const uint begin = tile * push.tile_items;
  const uint end = min(begin + push.tile_items, push.count);
  for (uint i = begin; i < end; ++i) ++push.counts.at[digit(push.words.at[i], push.shift) * push.tiles + tile];
}
