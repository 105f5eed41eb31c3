#version 460
#extension GL_GOOGLE_include_directive : require
#include "methods/vulkan/shaders/sah.glsl"
#include "methods/vulkan/shaders/sah_compare.glsl"
#include "methods/vulkan/shaders/sah_queue.glsl"
#include "methods/vulkan/shaders/sah_tiles.glsl"

// Finds the best split of a node, one workgroup a node, and writes the children. Nodes are first written as leaves, with their
// triangles' range: what becomes a leaf is done.
layout(push_constant, scalar) uniform Push {
  Boxes boxes;
  Uints indices;
  Nodes nodes;
  Uints from;       // the nodes to be split
  Uints decisions;  // two words each
  uint count;
  uint max_leaf;  // most triangles of a leaf
  float traversal;
  float intersection;
  float spacing;  // between samples, in lengths of the bounds
} push;

shared uint center_bounds[6];

void set_samples(uint begin, uint n) {
  const uint lane = gl_LocalInvocationID.x;
  for (uint k = lane; k < 6; k += gl_WorkGroupSize.x) center_bounds[k] = k < 3 ? ~0u : 0u;
  barrier();
  vec3 lower = vec3(infinity);
  vec3 upper = vec3(-infinity);
  for (uint i = lane; i < n; i += gl_WorkGroupSize.x) {
    const vec3 center = box_center(push.boxes.at[push.indices.at[begin + i]]);
    lower = min(lower, center);
    upper = max(upper, center);
  }
  for (uint axis = 0; axis < 3; ++axis) {
    atomicMin(center_bounds[axis], sortable(lower[axis]));
    atomicMax(center_bounds[3 + axis], sortable(upper[axis]));
  }
  barrier();
  for (uint axis = 0; axis < 3; ++axis) {
    lower[axis] = from_sortable(center_bounds[axis]);
    upper[axis] = from_sortable(center_bounds[3 + axis]);
  }
  for (uint k = 0; k < own; ++k) set_sample(k, number_of(k), lower, upper, push.spacing);
}

void set_positions(uint begin, uint n) {
  for (uint k = 0; k < own; ++k) {
    const uint axis = number_of(k) / samples;
    const uint i = number_of(k) % samples;
    set_candidate(k, no_axis, 0, 0);
    if (axis >= no_axis || i >= n) continue;
    const uint index = push.indices.at[begin + i];
    set_candidate(k, axis, along(box_center(push.boxes.at[index]), axis), index);
  }
}

void main() {
  const uint group = group_index();
  if (group >= push.count) return;
  const uint number = push.from.at[group];
  const Node node = push.nodes.at[number];
  const uint begin = node.first;
  const uint n = node.count;
  const bool positions = n <= samples;
  if (positions) set_positions(begin, n);
  else set_samples(begin, n);
  test_tiles(push.boxes, push.indices, begin, n, false);
  const float cost = compare_candidates(n);
  const float area = half_area(node.box);
  if (is_leaf(n, area, cost, push.traversal, push.intersection, push.max_leaf)) {
    if (gl_LocalInvocationID.x == 0) push.decisions.at[2 * group] = no_split;
    return;
  }
  // In the order of positions, or of places.
  const bool halve = tells_nothing(area, cost);
  const bool by_place = halve && !positions;
  if (by_place) {
    for (uint k = 0; k < own; ++k) set_candidate(k, no_axis, 0, n / 2 - 1);
    test_tiles(push.boxes, push.indices, begin, n, true);
  }
  for (uint k = 0; k < own; ++k) {
    bool best = is_best(k, n);
    if (by_place) best = number_of(k) == 0;
    else if (halve) best = candidates[k].axis == axis_to_halve(node.box, n) && candidates[k].lefts == n / 2;
    if (!best) continue;
    const Candidate c = candidates[k];
    const uint pair = 2 * (begin + c.lefts);
    push.nodes.at[pair] = Node(c.left, begin, c.lefts);
    push.nodes.at[pair + 1] = Node(c.right, begin + c.lefts, n - c.lefts);
    push.nodes.at[number].first = pair;
    push.nodes.at[number].count = 0;
    push.decisions.at[2 * group] = is_split | c.axis | (positions ? at_triangle : 0);
    push.decisions.at[2 * group + 1] = positions ? c.index : floatBitsToUint(c.position);
  }
}
