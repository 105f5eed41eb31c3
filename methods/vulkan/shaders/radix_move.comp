#version 460
#extension GL_GOOGLE_include_directive : require
#include "harness/vulkan/shaders/common.glsl"
#include "methods/vulkan/shaders/radix.glsl"
#include "methods/vulkan/shaders/workgroup_sum.glsl"

// Moves the items of a tile to where their digits go, equal ones in their order. Each invocation counts the digits of items that
// stand together in counters of its own; their prefix sums over digits, then invocations, say where each goes.
layout(constant_id = 3) const bool two_words = false;
layout(constant_id = 4) const bool numbered = false;  // the values of the items are their places, and are not read

layout(push_constant, scalar) uniform Push {
  Uints from_low;
  Uints from_high;
  Uints from_values;
  Uints to_low;
  Uints to_high;
  Uints to_values;
  Uints starts;  // [digit][tile]: where the first goes
  uint count;
  uint tiles;
  uint tile_items;  // those of the workgroup
  uint shift;
  uint high;  // whether the digit is in the high word
} push;

shared uint counters[digits * gl_WorkGroupSize.x];  // [digit][invocation]
shared uint distances[digits];

uint digit_of(uint i) { return digit(two_words && push.high != 0 ? push.from_high.at[i] : push.from_low.at[i], push.shift); }

void main() {
  const uint width = gl_WorkGroupSize.x;
  const uint lane = gl_LocalInvocationID.x;
  const uint tile = group_index();
  const uint begin = min(invocation_index() * items, push.count);
  const uint end = min(begin + items, push.count);

  for (uint c = lane; c < digits * width; c += width) counters[c] = 0;
  barrier();
  for (uint i = begin; i < end; ++i) ++counters[digit_of(i) * width + lane];
  barrier();
  uint sum = 0;
  for (uint c = lane * digits; c < (lane + 1) * digits; ++c) sum += counters[c];
  uint total;
  sum = sum_before(sum, total);
  for (uint c = lane * digits; c < (lane + 1) * digits; ++c) {
    const uint value = counters[c];
    counters[c] = sum;
    sum += value;
  }
  barrier();
  // From places within the tile to places of all.
  if (tile < push.tiles) {
    for (uint d = lane; d < digits; d += width) distances[d] = push.starts.at[d * push.tiles + tile] - counters[d * width];
  }
  barrier();
  for (uint i = begin; i < end; ++i) {
    const uint low = push.from_low.at[i];
    const uint high = two_words ? push.from_high.at[i] : 0;
    const uint d = digit(push.high != 0 ? high : low, push.shift);
    const uint place = counters[d * width + lane];
    counters[d * width + lane] = place + 1;
    const uint to = place + distances[d];
    push.to_low.at[to] = low;
    if (two_words) push.to_high.at[to] = high;
    push.to_values.at[to] = numbered ? i : push.from_values.at[i];
  }
}
