#version 460
#extension GL_GOOGLE_include_directive : require
#include "methods/vulkan/shaders/scene.glsl"
#include "methods/vulkan/shaders/morton.glsl"

// The Morton code of every triangle's box.
layout(constant_id = 1) const uint items = 1;  // triangles of an invocation
layout(constant_id = 2) const uint bits = 10;  // an axis; more than 10 make codes of two words

layout(push_constant, scalar) uniform Push {
  Boxes boxes;
  Grids grid;
  Uints low;
  Uints high;
  uint count;
} push;

void main() {
  const Grid grid = push.grid.at[0];
  const uint begin = group_index() * gl_WorkGroupSize.x * items + gl_LocalInvocationID.x;
  for (uint k = 0; k < items; ++k) {
    const uint i = begin + k * gl_WorkGroupSize.x;
    if (i >= push.count) return;
    const vec3 center = box_center(push.boxes.at[i]);
    const uvec3 cell = cell_of(grid, center, bits);
    if (bits > 10) {
      push.low.at[i] = low_code_of_21(cell);
      push.high.at[i] = high_code_of_21(cell);
    } else {
      push.low.at[i] = code_of_10(cell);
    }
  }
}
