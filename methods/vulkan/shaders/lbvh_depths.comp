#version 460
#extension GL_GOOGLE_include_directive : require
#include "methods/vulkan/shaders/scene.glsl"
#include "methods/vulkan/shaders/lbvh.glsl"

// The depth of the split behind every place but the last.
layout(constant_id = 1) const uint items = 1;  // places of an invocation
layout(constant_id = 3) const bool two_words = false;

layout(push_constant, scalar) uniform Push {
  Uints low;
  Uints high;
  Uints depths;
  uint count;
} push;

uvec2 code_at(uint i) { return uvec2(push.low.at[i], two_words ? push.high.at[i] : 0); }

void main() {
  const uint begin = invocation_index() * items;
  const uint end = min(begin + items, push.count - 1);
  if (begin >= end) return;
  uvec2 code = code_at(begin);
  for (uint i = begin; i < end; ++i) {
    const uvec2 next = code_at(i + 1);
    push.depths.at[i] = common_prefix(code, next, i, i + 1);
    code = next;
  }
}
