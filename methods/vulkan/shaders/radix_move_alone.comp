#version 460
#extension GL_GOOGLE_include_directive : require
#include "harness/vulkan/shaders/common.glsl"
#include "methods/vulkan/shaders/radix.glsl"

// radix_move.comp for processors: an invocation moves the items of its tile one after another.
layout(constant_id = 3) const bool two_words = false;
layout(constant_id = 4) const bool numbered = false;

layout(push_constant, scalar) uniform Push {
  Uints from_low;
  Uints from_high;
  Uints from_values;
  Uints to_low;
  Uints to_high;
  Uints to_values;
  Uints starts;
  uint count;
  uint tiles;
  uint tile_items;
  uint shift;
  uint high;
} push;

void main() {
  const uint tile = invocation_index();
  if (tile >= push.tiles) return;
  const uint begin = tile * push.tile_items;
  const uint end = min(begin + push.tile_items, push.count);
  for (uint i = begin; i < end; ++i) {
    const uint low = push.from_low.at[i];
    const uint high = two_words ? push.from_high.at[i] : 0;
    const uint counter = digit(push.high != 0 ? high : low, push.shift) * push.tiles + tile;
    const uint to = push.starts.at[counter];
    push.starts.at[counter] = to + 1;
    push.to_low.at[to] = low;
    if (two_words) push.to_high.at[to] = high;
    push.to_values.at[to] = numbered ? i : push.from_values.at[i];
  }
}
