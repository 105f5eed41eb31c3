#version 460
#extension GL_GOOGLE_include_directive : require
#include "methods/vulkan/shaders/sah.glsl"

// Builds the whole subtree of a node of few triangles, one workgroup a node and one invocation a triangle, in shared memory: its
// nodes are split level by level, all of a level at once. Every triangle is a candidate of its node on three axes.
layout(push_constant, scalar) uniform Push {
  Boxes boxes;
  Uints indices;
  Nodes nodes;
  Uints queue;  // nodes from the end on
  uint capacity;
  uint count;
  uint max_leaf;
  float traversal;
  float intersection;
} push;

const uint width = gl_WorkGroupSize.x;

// A place's triangle, and the node that it is in.
struct Place {
  Box box;
  uint triangle;
  uint node;
  uint first;  // place where the node begins
  uint count;  // triangles of the node; 0: it is a leaf
};
shared Place places[width];

// Of a node, at its first place.
shared uint least_cost[width];
shared uint least_rank[width];
shared uint lefts_of[width];  // 0: it is not split
shared uint axis_of[width];
shared uint splitter_of[width];  // place of the triangle that it is split at
shared uint any_open;

void make_children(uint begin, Place p, uint k, uint lane) {
  const Candidate c = candidates[k];
  const uint pair = 2 * (begin + p.first + c.lefts);
  push.nodes.at[pair] = Node(c.left, begin + p.first, c.lefts);
  push.nodes.at[pair + 1] = Node(c.right, begin + p.first + c.lefts, p.count - c.lefts);
  push.nodes.at[p.node].first = pair;
  push.nodes.at[p.node].count = 0;
  lefts_of[p.first] = c.lefts;
  axis_of[p.first] = k;
  splitter_of[p.first] = lane;
}

void test_node(Place p, uint lane) {
  const vec3 center = box_center(p.box);
  for (uint k = 0; k < own; ++k) set_candidate(k, k, along(center, k), p.triangle);
  for (uint j = p.first; j < p.first + p.count; ++j) test(places[j].box, box_center(places[j].box), places[j].triangle);
  for (uint k = 0; k < own; ++k) {
    set_cost(k, p.count);
    if (candidates[k].cost < infinity) atomicMin(least_cost[p.first], floatBitsToUint(candidates[k].cost));
  }
}

void rank_candidates(Place p) {
  const float least = uintBitsToFloat(least_cost[p.first]);
  for (uint k = 0; k < own; ++k) {
    if (candidates[k].cost == least && least < infinity) atomicMin(least_rank[p.first], rank_of(k, p.count, 0));
  }
}

void split_node(uint begin, Place p, uint lane) {
  const float least = uintBitsToFloat(least_cost[p.first]);
  const Box box = Box(min(candidates[0].left.lower, candidates[0].right.lower),
                      max(candidates[0].left.upper, candidates[0].right.upper));
  const float area = half_area(box);
  if (is_leaf(p.count, area, least, push.traversal, push.intersection, push.max_leaf)) return;
  const bool halve = tells_nothing(area, least);
  const uint axis = axis_to_halve(box, p.count);
  for (uint k = 0; k < own; ++k) {
    const bool best = halve ? k == axis && candidates[k].lefts == p.count / 2
                            : candidates[k].cost == least && rank_of(k, p.count, 0) == least_rank[p.first];
    if (best) make_children(begin, p, k, lane);
  }
}

bool place_goes_left(uint place, uint axis, Place splitter) {
  return goes_left(along(box_center(places[place].box), axis), places[place].triangle, along(box_center(splitter.box), axis),
                   splitter.triangle);
}

// Where the place's triangle goes; `p` becomes what will be there.
uint move(uint begin, inout Place p, uint lane) {
  const uint lefts = lefts_of[p.first];
  if (p.count < 2 || lefts == 0) {
    p.count = 0;
    return lane;
  }
  const uint axis = axis_of[p.first];
  const Place splitter = places[splitter_of[p.first]];
  uint before = 0;
  for (uint j = p.first; j < lane; ++j) before += place_goes_left(j, axis, splitter) ? 1 : 0;
  const bool left = place_goes_left(lane, axis, splitter);
  const uint to = p.first + (left ? before : lefts + lane - p.first - before);
  p.node = 2 * (begin + p.first + lefts) + (left ? 0 : 1);
  p.first += left ? 0 : lefts;
  p.count = left ? lefts : p.count - lefts;
  return to;
}

void main() {
  const uint group = group_index();
  if (group >= push.count) return;
  const uint lane = gl_LocalInvocationID.x;
  const uint number = push.queue.at[push.capacity - 1 - group];
  const uint begin = push.nodes.at[number].first;
  const uint n = push.nodes.at[number].count;
  barrier();
  Place p;
  p.count = 0;
  if (lane < n) {
    const uint triangle = push.indices.at[begin + lane];
    p = Place(push.boxes.at[triangle], triangle, number, 0, n);
    places[lane] = p;
  }
  bool open = true;
  while (open) {
    least_cost[lane] = floatBitsToUint(infinity);
    least_rank[lane] = ~0u;
    lefts_of[lane] = 0;
    if (lane == 0) any_open = 0;
    barrier();
    if (p.count > 1) test_node(p, lane);
    barrier();
    if (p.count > 1) rank_candidates(p);
    barrier();
    if (p.count > 1) split_node(begin, p, lane);
    barrier();
    uint to = lane;
    if (lane < n) to = move(begin, p, lane);
    barrier();
    if (lane < n) {
      places[to] = p;
      if (p.count > 1) any_open = 1;
    }
    barrier();
    if (lane < n) p = places[lane];
    open = any_open != 0;
    barrier();
  }
  if (lane < n) push.indices.at[begin + lane] = p.triangle;
}
