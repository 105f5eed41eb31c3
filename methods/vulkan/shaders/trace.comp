#version 460
#extension GL_GOOGLE_include_directive : require
#include "methods/vulkan/shaders/traversal.glsl"
#include "methods/vulkan/shaders/ray.glsl"

// Closest or any hits of rays, one invocation a ray: while-while traversal (Aila and Laine 2009), the nearer child first, with a
// stack of which the first entries are at hand and the others in memory.
//
// Invocations do a limited number of steps. What is then not done is listed, and traced by dispatches with `long_rays`, between
// which each ray's state and its whole stack are in memory.
layout(constant_id = 1) const bool any_hit = false;
layout(constant_id = 2) const bool counting = false;
layout(constant_id = 3) const bool persistent = false;  // invocations fetch rays until there are none, instead of one each
layout(constant_id = 4) const bool stack_is_shared = false;
layout(constant_id = 5) const uint stack_entries = 16;  // at hand
layout(constant_id = 6) const uint step_limit = 1000;
layout(constant_id = 7) const bool long_rays = false;
layout(constant_id = 8) const bool spills = true;  // whether the tree is deeper than what is at hand

layout(buffer_reference, scalar, buffer_reference_align = 8) buffer Entries { uvec2 at[]; };

layout(push_constant, scalar) uniform Push {
  Bits pairs;
  Bits triangles;
  Bits rays;
  Uints hits;        // t, triangle, u, v of each ray
  Uints counts;      // inner nodes, leaves, boxes, triangles of each ray
  Entries spill;     // entry e beyond those at hand of invocation i: [e · invocations + i]
  Uints progress;    // the next ray to be fetched; the number of unfinished rays
  Uints unfinished;  // their numbers; of long rays those to be traced
  Uints states;      // of long rays: word k of invocation i: [k · invocations + i]
  vec3 lower;  // the tree's box
  vec3 upper;
  uint root;
  uint ray_count;
  uint invocations;
  uint resumed;  // whether long rays have states
} push;

const uint no_hit = 0xffffffffu;
// No nodes have these references, which have the leaf bit.
const uint done = 0xffffffffu;
const uint pop_next = 0xfffffffeu;

const uint private_entries = stack_is_shared || stack_entries == 0 ? 1 : stack_entries;
const uint shared_entries = stack_is_shared ? stack_entries * gl_WorkGroupSize.x : 1;

// A stack's entry: a node's reference, and the bits of where its box is entered.
shared uvec2 shared_stack[shared_entries];
uvec2 private_stack[private_entries];
uint stack_size;
uint steps;  // loop iterations, at least as many as this invocation makes its subgroup do

void push_node(uvec2 entry) {
  if (spills && stack_size >= stack_entries) {
    push.spill.at[(stack_size - stack_entries) * push.invocations + invocation_index()] = entry;
  } else if (stack_is_shared) {
    shared_stack[stack_size * gl_WorkGroupSize.x + gl_LocalInvocationID.x] = entry;
  } else {
    private_stack[stack_size] = entry;
  }
  ++stack_size;
}

// The topmost node, or again pop_next where it is entered later than at `farthest`.
uint pop_node(float farthest) {
  if (stack_size == 0) return done;
  --stack_size;
  uvec2 entry;
  if (spills && stack_size >= stack_entries) {
    entry = push.spill.at[(stack_size - stack_entries) * push.invocations + invocation_index()];
  } else if (stack_is_shared) {
    entry = shared_stack[stack_size * gl_WorkGroupSize.x + gl_LocalInvocationID.x];
  } else {
    entry = private_stack[stack_size];
  }
  return uintBitsToFloat(entry.y) > farthest ? pop_next : entry.x;
}

vec2 floats(double bits) { return uintBitsToFloat(unpackDouble2x32(bits)); }

struct State {
  TracedRay ray;
  float tmax;      // of the ray, or where the nearest hit is
  float farthest;  // the same, scaled
  float nearest;   // the ray's tmin, scaled
  uvec3 hit;       // triangle, u, v
  uvec4 counts;
};

uint visit_pair(inout State s, uint index) {
  if (counting) s.counts += uvec4(1, 0, 2, 0);
  const uint at = index * (pair_floats / 2);
  vec2 near = vec2(s.nearest);
  vec2 far = vec2(s.farthest);
  for (uint axis = 0; axis < 3; ++axis) {
    narrow(s.ray, axis, floats(push.pairs.at[at + 2 * axis]), floats(push.pairs.at[at + 2 * axis + 1]), near, far);
  }
  const uvec2 references = unpackDouble2x32(push.pairs.at[at + pair_references / 2]);
  const bvec2 met = lessThanEqual(near, far);
  if (all(met)) {
    const bool swapped = near.y < near.x;
    push_node(swapped ? uvec2(references.x, floatBitsToUint(near.x)) : uvec2(references.y, floatBitsToUint(near.y)));
    return swapped ? references.y : references.x;
  }
  return met.x ? references.x : met.y ? references.y : pop_next;
}

// Tests triangles from `slot` to the end of the leaf; gives what comes next, which is the rest of the leaf after too many steps.
uint visit_leaf(inout State s, uint slot) {
  if (counting) ++s.counts.y;
  for (;; ++slot) {
    ++steps;
    if (counting) ++s.counts.w;
    const uint at = slot * (triangle_words / 2);
    const vec2 w0 = floats(push.triangles.at[at]);
    const vec2 w1 = floats(push.triangles.at[at + 1]);
    const vec2 w2 = floats(push.triangles.at[at + 2]);
    const vec2 w3 = floats(push.triangles.at[at + 3]);
    const uvec2 w4 = unpackDouble2x32(push.triangles.at[at + 4]);
    const uint triangle = w4.y & ~last_bit;
    vec3 found;
    if (intersect(s.ray, vec3(w0, w1.x), vec3(w1.y, w2), vec3(w3, uintBitsToFloat(w4.x)), s.tmax, found) &&
        !(found.x == s.tmax && s.hit.x < triangle)) {
      s.tmax = found.x;
      s.farthest = scaled(s.ray, s.tmax);
      s.hit = uvec3(triangle, floatBitsToUint(found.yz));
      if (any_hit) return done;
    }
    if ((w4.y & last_bit) != 0) return pop_next;
    if (steps >= step_limit) {
      if (counting) --s.counts.y;
      return (slot + 1) | leaf_bit;
    }
  }
}

// False where the ray hits nothing.
bool begin(out State s, uint index) {
  const vec2 r0 = floats(push.rays.at[index * 4]);
  const vec2 r1 = floats(push.rays.at[index * 4 + 1]);
  const vec2 r2 = floats(push.rays.at[index * 4 + 2]);
  const vec2 r3 = floats(push.rays.at[index * 4 + 3]);
  s.tmax = r3.y;
  s.hit = uvec3(no_hit, 0, 0);
  s.counts = uvec4(0);
  if (!prepare(vec3(r0, r1.x), vec3(r2, r3.x), r1.y, r3.y, push.lower, push.upper, s.ray)) return false;
  s.farthest = scaled(s.ray, s.tmax);
  s.nearest = scaled(s.ray, s.ray.tmin);
  if (counting) s.counts.z = 1;
  vec2 near = vec2(s.nearest);
  vec2 far = vec2(s.farthest);
  for (uint axis = 0; axis < 3; ++axis) narrow(s.ray, axis, vec2(push.lower[axis]), vec2(push.upper[axis]), near, far);
  return near.x <= far.x;
}

void finish(State s, uint index) {
  const bool is_hit = s.hit.x != no_hit;
  push.hits.at[4 * index] = is_hit ? floatBitsToUint(s.tmax) : floatBitsToUint(infinity);
  push.hits.at[4 * index + 1] = s.hit.x;
  push.hits.at[4 * index + 2] = s.hit.y;
  push.hits.at[4 * index + 3] = s.hit.z;
  if (counting) {
    for (uint k = 0; k < 4; ++k) push.counts.at[4 * index + k] = s.counts[k];
  }
}

// Goes on from `node` until the ray is done or the steps are used up; gives the node that is then next.
uint traverse(inout State s, uint node) {
  while (node != done && steps < step_limit) {
    steps += 2;
    while (((node & leaf_bit) == 0 || node == pop_next) && steps < step_limit) {
      ++steps;
      if (node == pop_next) node = pop_node(s.farthest);
      if ((node & leaf_bit) == 0) node = visit_pair(s, node);
    }
    if ((node & leaf_bit) != 0 && node < pop_next) node = visit_leaf(s, node & ~leaf_bit);
  }
  return node;
}

void load_state(inout State s, out uint node) {
  const uint i = invocation_index();
  uint words[10];
  for (uint k = 0; k < 10; ++k) words[k] = push.states.at[k * push.invocations + i];
  node = words[0];
  stack_size = words[1];
  s.tmax = uintBitsToFloat(words[2]);
  s.farthest = scaled(s.ray, s.tmax);
  s.hit = uvec3(words[3], words[4], words[5]);
  s.counts = uvec4(words[6], words[7], words[8], words[9]);
}

void save_state(State s, uint node) {
  const uint i = invocation_index();
  const uint words[10] = {node,    stack_size, floatBitsToUint(s.tmax), s.hit.x,    s.hit.y,
                          s.hit.z, s.counts.x, s.counts.y,              s.counts.z, s.counts.w};
  for (uint k = 0; k < 10; ++k) push.states.at[k * push.invocations + i] = words[k];
}

void trace_long_ray() {
  const uint i = invocation_index();
  if (i >= push.ray_count) return;
  const uint index = push.unfinished.at[i];
  State s;
  stack_size = 0;
  steps = 0;
  uint node = begin(s, index) ? push.root : done;
  if (push.resumed != 0) load_state(s, node);
  if (push.resumed != 0 && node == done) return;
  node = traverse(s, node);
  save_state(s, node);
  if (node == done) {
    finish(s, index);
  } else {
    atomicAdd(push.progress.at[1], 1);
  }
}

void trace(uint index) {
  State s;
  stack_size = 0;
  uint node = begin(s, index) ? push.root : done;
  node = traverse(s, node);
  if (node == done) {
    finish(s, index);
  } else {
    push.unfinished.at[atomicAdd(push.progress.at[1], 1)] = index;
  }
}

void main() {
  if (long_rays) {
    trace_long_ray();
    return;
  }
  steps = 0;
  if (!persistent) {
    const uint index = invocation_index();
    if (index < push.ray_count) trace(index);
    return;
  }
  // No ray is begun that could be expected not to be done.
  while (steps < step_limit / 2) {
    steps += 2;
    const uint index = atomicAdd(push.progress.at[0], 1);
    if (index >= push.ray_count) return;
    trace(index);
  }
}
