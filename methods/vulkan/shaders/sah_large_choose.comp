#version 460
#extension GL_GOOGLE_include_directive : require
#include "methods/vulkan/shaders/sah.glsl"
#include "methods/vulkan/shaders/sah_compare.glsl"
#include "methods/vulkan/shaders/sah_segments.glsl"

// Finds the best split of a large node from what its segments found, with one workgroup, and writes the children.
layout(push_constant, scalar) uniform Push {
  Nodes nodes;
  Minima minima;
  Maxima maxima;
  Results result;
  uint node;
  uint max_leaf;
  float traversal;
  float intersection;
  float spacing;
} push;

Box box_of(uint candidate, uint side) {
  Box box;
  for (uint axis = 0; axis < 3; ++axis) {
    box.lower[axis] = from_sortable(push.minima.at[6 * candidate + 3 * side + axis]);
    box.upper[axis] = from_sortable(push.maxima.at[7 * candidate + 3 * side + axis]);
  }
  return box;
}

void write_children(Candidate c, uint begin, uint n) {
  const uint pair = 2 * (begin + c.lefts);
  push.nodes.at[pair] = Node(c.left, begin, c.lefts);
  push.nodes.at[pair + 1] = Node(c.right, begin + c.lefts, n - c.lefts);
  push.nodes.at[push.node].first = pair;
  push.nodes.at[push.node].count = 0;
  push.result.at[0] = Result(c.lefts, c.axis, c.position, c.index);
}

void main() {
  if (group_index() > 0) return;
  const Node node = push.nodes.at[push.node];
  const uint begin = node.first;
  const uint n = node.count;
  vec3 lower;
  vec3 upper;
  for (uint axis = 0; axis < 3; ++axis) {
    lower[axis] = from_sortable(push.minima.center[axis]);
    upper[axis] = from_sortable(push.maxima.center[axis]);
  }
  for (uint k = 0; k < own; ++k) {
    const uint number = number_of(k);
    set_sample(k, number, lower, upper, push.spacing);
    if (candidates[k].axis == no_axis) continue;
    candidates[k].lefts = push.maxima.at[7 * number + 6];
    candidates[k].left = box_of(number, 0);
    candidates[k].right = box_of(number, 1);
  }
  const float cost = compare_candidates(n);
  const float area = half_area(node.box);
  const bool first = gl_LocalInvocationID.x == 0;
  if (is_leaf(n, area, cost, push.traversal, push.intersection, push.max_leaf)) {
    if (first) push.result.at[0] = Result(0, no_axis, 0, 0);
    return;
  }
  if (tells_nothing(area, cost)) {
    const uint halves = 3 * samples;
    if (first) write_children(Candidate(no_axis, 0, 0, n / 2, box_of(halves, 0), box_of(halves, 1), cost), begin, n);
    return;
  }
  for (uint k = 0; k < own; ++k) {
    if (is_best(k, n)) write_children(candidates[k], begin, n);
  }
}
