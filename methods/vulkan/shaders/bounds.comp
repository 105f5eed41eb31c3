#version 460
#extension GL_GOOGLE_include_directive : require
#include "methods/vulkan/shaders/scene.glsl"

// The box of every triangle, and the box of them all (its six numbers in sortable form, begun as an empty box by the host).
layout(constant_id = 1) const uint items = 1;  // triangles of an invocation

layout(push_constant, scalar) uniform Push {
  Vertices vertices;
  Triangles triangles;
  Boxes boxes;
  Uints bounds;
  uint count;
} push;

shared uint group_bounds[6];

void main() {
  const uint lane = gl_LocalInvocationID.x;
  for (uint k = lane; k < 6; k += gl_WorkGroupSize.x) group_bounds[k] = k < 3 ? ~0u : 0u;
  barrier();
  Box all = empty_box();
  const uint begin = group_index() * gl_WorkGroupSize.x * items + lane;
  for (uint k = 0; k < items; ++k) {
    const uint i = begin + k * gl_WorkGroupSize.x;
    if (i >= push.count) break;
    const uvec3 t = push.triangles.at[i];
    const vec3 a = push.vertices.at[t.x];
    const vec3 b = push.vertices.at[t.y];
    const vec3 c = push.vertices.at[t.z];
    const Box box = Box(min(min(a, b), c), max(max(a, b), c));
    push.boxes.at[i] = box;
    all = united(all, box);
  }
  for (uint axis = 0; axis < 3; ++axis) {
    atomicMin(group_bounds[axis], sortable(all.lower[axis]));
    atomicMax(group_bounds[3 + axis], sortable(all.upper[axis]));
  }
  barrier();
  for (uint k = lane; k < 3; k += gl_WorkGroupSize.x) {
    atomicMin(push.bounds.at[k], group_bounds[k]);
    atomicMax(push.bounds.at[3 + k], group_bounds[3 + k]);
  }
}
