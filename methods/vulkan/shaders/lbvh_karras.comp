#version 460
#extension GL_GOOGLE_include_directive : require
#include "methods/vulkan/shaders/scene.glsl"
#include "methods/vulkan/shaders/lbvh.glsl"

// The hierarchy by binary searches alone (Karras 2012, Sec. 4): invocation i finds the node whose range begins or ends at leaf i. A
// leaf is known by its first triangle.
layout(constant_id = 3) const bool two_words = false;

layout(push_constant, scalar) uniform Push {
  Uints low;
  Uints high;
  Uints leaf_first;
  Nodes nodes;
  Uints slots;  // of each split, where the node that it splits stands
  uint leaves;
} push;

uint place_of(uint leaf) { return one_a_leaf ? leaf : push.leaf_first.at[leaf]; }
uvec2 code_at(uint place) { return uvec2(push.low.at[place], two_words ? push.high.at[place] : 0); }

uint place;
uvec2 code;

// Bits that the keys of leaf i and of leaf j have in common; -1 where there is no leaf j.
int prefix_with(int j) {
  if (j < 0 || j >= int(push.leaves)) return -1;
  const uint other = place_of(uint(j));
  return int(common_prefix(code, code_at(other), place, other));
}

void main() {
  const int i = int(invocation_index());
  if (i + 1 >= int(push.leaves)) return;
  place = place_of(uint(i));
  code = code_at(place);
  const int behind = prefix_with(i + 1);
  const int before = prefix_with(i - 1);
  const int direction = behind > before ? 1 : -1;
  const int outside = min(behind, before);
  int most = 2;
  while (prefix_with(i + most * direction) > outside) most *= 2;
  int length = 0;
  for (int step = most / 2; step > 0; step /= 2) {
    if (prefix_with(i + (length + step) * direction) > outside) length += step;
  }
  const int shared_prefix = prefix_with(i + length * direction);
  int distance = 0;
  for (int step = length; step > 1;) {
    step = (step + 1) / 2;
    if (prefix_with(i + (distance + step) * direction) > shared_prefix) distance += step;
  }
  const uint split = uint(i + distance * direction + min(direction, 0));
  const uint slot = i == 0 ? 0 : direction > 0 ? right_slot(uint(i)) : left_slot(uint(i));
  push.nodes.at[slot].first = children_of(split);
  push.nodes.at[slot].count = 0;
  push.slots.at[split] = slot;
}
