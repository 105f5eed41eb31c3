#version 460
#extension GL_GOOGLE_include_directive : require
#include "methods/vulkan/shaders/scene.glsl"
#include "methods/vulkan/shaders/morton.glsl"

// One invocation: the grid over the bounds that bounds.comp left.
layout(push_constant, scalar) uniform Push {
  Uints bounds;
  Grids grid;
  uint bits;  // an axis
} push;

void main() {
  if (invocation_index() != 0) return;
  vec3 lower;
  vec3 upper;
  for (uint axis = 0; axis < 3; ++axis) {
    lower[axis] = from_sortable(push.bounds.at[axis]);
    upper[axis] = from_sortable(push.bounds.at[3 + axis]);
  }
  push.grid.at[0] = grid_over(lower, upper, push.bits);
}
