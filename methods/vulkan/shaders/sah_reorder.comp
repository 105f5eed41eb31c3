#version 460
#extension GL_GOOGLE_include_directive : require
#include "methods/vulkan/shaders/sah.glsl"
#include "methods/vulkan/shaders/sah_queue.glsl"
#include "methods/vulkan/shaders/workgroup_sum.glsl"

// Brings the indices of a node's triangles into the order of its children, equal ones in their order, one workgroup a node, and
// puts children of two triangles and more where the decision was.
layout(buffer_reference, scalar, buffer_reference_align = 4) coherent buffer SharedUints { uint at[]; };

layout(push_constant, scalar) uniform Push {
  Boxes boxes;
  Uints indices;
  SharedUints scratch;
  Nodes nodes;
  Uints from;  // the nodes that were to be split
  Uints to;    // decisions, then children
  uint count;
  uint small;  // most triangles of a child for the small-split kernel
} push;

// In place for those that go left; the others wait in `scratch`.
void reorder(uint begin, uint n, uint axis, float position, uint index) {
  const uint lane = gl_LocalInvocationID.x;
  uint lefts = 0;
  for (uint tile = 0; tile < n; tile += gl_WorkGroupSize.x) {
    const uint i = tile + lane;
    const uint triangle = i < n ? push.indices.at[begin + i] : 0;
    const bool left = i < n && goes_left(along(box_center(push.boxes.at[triangle]), axis), triangle, position, index);
    uint total;
    const uint rank = sum_before(left ? 1 : 0, total);
    if (left) push.indices.at[begin + lefts + rank] = triangle;
    else if (i < n) push.scratch.at[begin + i - lefts - rank] = triangle;
    lefts += total;
  }
  memoryBarrierBuffer();
  barrier();
  for (uint i = lefts + lane; i < n; i += gl_WorkGroupSize.x) push.indices.at[begin + i] = push.scratch.at[begin + i - lefts];
}

void main() {
  const uint group = group_index();
  if (group >= push.count) return;
  const uint lane = gl_LocalInvocationID.x;
  const uint decision = push.to.at[2 * group];
  const uint where = push.to.at[2 * group + 1];
  barrier();
  if (decision == no_split) {
    if (lane < 2) push.to.at[2 * group + lane] = no_child;
    return;
  }
  const uint pair = push.nodes.at[push.from.at[group]].first;
  const uint begin = push.nodes.at[pair].first;
  const uint lefts = push.nodes.at[pair].count;
  const uint rights = push.nodes.at[pair + 1].count;
  const uint axis = decision & 3;
  if (axis != no_axis) {
    const bool at = (decision & at_triangle) != 0;
    const float position = at ? along(box_center(push.boxes.at[where]), axis) : uintBitsToFloat(where);
    reorder(begin, lefts + rights, axis, position, at ? where : ~0u);
  }
  if (lane == 0) {
    push.to.at[2 * group] = queued(pair, lefts, push.small);
    push.to.at[2 * group + 1] = queued(pair + 1, rights, push.small);
  }
}
