// One split by the surface area heuristic (Lauterbach 2010, Sec. 5.2.2): every invocation has candidates of its own, all see every
// triangle of the node, and the least cost wins. README.md defines the candidates.
#include "methods/vulkan/shaders/scene.glsl"
#include "methods/vulkan/shaders/morton.glsl"

layout(constant_id = 1) const uint samples = 64;  // candidates an axis
layout(constant_id = 2) const uint own = 1;       // candidates of an invocation

#define infinity uintBitsToFloat(0x7f800000u)
const uint no_axis = 3;

// Triangles with (center, index) up to (position, index) go to the left.
struct Candidate {
  uint axis;
  float position;
  uint index;
  uint lefts;  // triangles on the left
  Box left;
  Box right;
  float cost;
};
Candidate candidates[own];

float along(vec3 v, uint axis) { return axis == 0 ? v.x : axis == 1 ? v.y : v.z; }
bool goes_left(float center, uint triangle, float position, uint index) {
  return center < position || center == position && triangle <= index;
}

float half_area(Box box) {
  precise const vec3 e = box.upper - box.lower;
  precise const float area = e.x * e.y + e.y * e.z + e.z * e.x;
  return area;
}

uint longest_axis(Box box) {
  const vec3 e = box.upper - box.lower;
  if (e.x >= e.y && e.x >= e.z) return 0;
  return e.y >= e.z ? 1 : 2;
}

void set_candidate(uint k, uint axis, float position, uint index) {
  const Box none = Box(vec3(infinity), vec3(-infinity));
  candidates[k] = Candidate(axis, position, index, 0, none, none, infinity);
}

// Which candidate of the workgroup an invocation's k-th is.
uint number_of(uint k) { return gl_LocalInvocationID.x + k * gl_WorkGroupSize.x; }

// Candidate `number` of a node of more triangles than there are samples: uniformly between the least and the greatest center.
void set_sample(uint k, uint number, vec3 lower, vec3 upper, float spacing) {
  const uint axis = min(number / samples, no_axis);
  precise const float t = float(number % samples + 1) * spacing;
  precise const float position = along(lower, axis) * (1 - t) + along(upper, axis) * t;
  set_candidate(k, axis, position, ~0u);
}

void test(Box box, vec3 center, uint index) {
  for (uint k = 0; k < own; ++k) {
    const bool left = goes_left(along(center, candidates[k].axis), index, candidates[k].position, candidates[k].index);
    candidates[k].lefts += left ? 1 : 0;
    candidates[k].left.lower = min(candidates[k].left.lower, left ? box.lower : vec3(infinity));
    candidates[k].left.upper = max(candidates[k].left.upper, left ? box.upper : vec3(-infinity));
    candidates[k].right.lower = min(candidates[k].right.lower, left ? vec3(infinity) : box.lower);
    candidates[k].right.upper = max(candidates[k].right.upper, left ? vec3(-infinity) : box.upper);
  }
}

// Which of equal costs is taken: the first axis; in it the most balanced of the positions of triangles, the first of the samples.
uint rank_of(uint k, uint n, uint number) {
  if (n > samples) return number;
  const uint lefts = candidates[k].lefts;
  return candidates[k].axis << 16 | uint(abs(int(2 * lefts) - int(n))) << 1 | (2 * lefts > n ? 1 : 0);
}

// Measures a candidate that has seen the n triangles.
void set_cost(uint k, uint n) {
  const uint lefts = candidates[k].lefts;
  if (candidates[k].axis == no_axis || lefts == 0 || lefts == n) return;
  precise const float cost = half_area(candidates[k].left) * float(lefts) + half_area(candidates[k].right) * float(n - lefts);
  if (cost < infinity) candidates[k].cost = cost;
}

// Whether a leaf costs no more than the best split.
bool is_leaf(uint n, float area, float split_cost, float traversal, float intersection, uint max_leaf) {
  if (n > max_leaf) return false;
  precise const float leaf = intersection * area * float(n);
  precise const float split = traversal * area + intersection * split_cost;
  return leaf <= split;
}

// Where the measure tells nothing, a node is halved.
bool tells_nothing(float area, float split_cost) { return split_cost == infinity || !(area > 0); }
uint axis_to_halve(Box box, uint n) { return n == 2 ? 0 : longest_axis(box); }
