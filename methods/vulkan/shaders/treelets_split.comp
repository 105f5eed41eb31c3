#version 460
#extension GL_GOOGLE_include_directive : require
#include "methods/vulkan/shaders/treelets.glsl"
#include "methods/vulkan/shaders/morton.glsl"
#include "methods/vulkan/shaders/workgroup_sum.glsl"

// Splits nodes over several treelets by a binned SAH, a workgroup a node (Pantaleoni and Luebke 2010, Sec. 4.2; Garanzha et al. 2011).
layout(constant_id = 1) const uint bins = 2;

layout(push_constant, scalar) uniform Push {
  Nodes roots;          // of the treelets
  Uints treelet_first;  // leaf
  Uints leaf_first;     // triangle
  Uints from;           // treelets in the order of this level
  Uints to;             // and of the next
  Tasks tasks;
  Tasks next_tasks;
  Queues queues;
  Nodes nodes;
  Places places;
  uint level;
} push;

const uint grid_bits = 16;
const uint no_split = 3 * (bins - 1);

shared uint center_bounds[6];
shared float half_lower[3];
shared float scale[3];
// Of each axis and bin; bounds in sortable form.
shared uint bin_bounds[3 * bins * 6];
shared uint bin_treelets[3 * bins];
shared uint bin_leaves[3 * bins];
shared uint bin_triangles[3 * bins];
shared float right_costs[3 * bins];
shared float axis_costs[3];
shared uint axis_splits[3];
shared uint node_bounds[6];
// Of the left side, by the best split of each axis, and by that which is taken.
shared uint axis_left[3][3];
shared uint left_treelets;
shared uint left_leaves;
shared uint left_triangles;

struct Side {
  uint bounds[6];
  uint treelets;
  uint leaves;
  uint triangles;
};

uint leaves_of(uint t) { return push.treelet_first.at[t + 1] - push.treelet_first.at[t]; }
uint triangles_of(uint t) { return push.leaf_first.at[push.treelet_first.at[t + 1]] - push.leaf_first.at[push.treelet_first.at[t]]; }

uvec3 bins_of(Box box) {
  const Grid grid = Grid(vec3(half_lower[0], half_lower[1], half_lower[2]), vec3(scale[0], scale[1], scale[2]));
  return cell_of(grid, box_center(box), grid_bits) * bins >> grid_bits;
}

void find_grid(Task task) {
  const uint lane = gl_LocalInvocationID.x;
  for (uint k = lane; k < 6; k += gl_WorkGroupSize.x) center_bounds[k] = k < 3 ? ~0u : 0u;
  barrier();
  for (uint i = task.begin + lane; i < task.end; i += gl_WorkGroupSize.x) {
    const vec3 center = box_center(push.roots.at[push.from.at[i]].box);
    for (uint axis = 0; axis < 3; ++axis) {
      atomicMin(center_bounds[axis], sortable(center[axis]));
      atomicMax(center_bounds[3 + axis], sortable(center[axis]));
    }
  }
  barrier();
  for (uint axis = lane; axis < 3; axis += gl_WorkGroupSize.x) {
    half_lower[axis] = 0.5 * from_sortable(center_bounds[axis]);
    precise const float h = 0.5 * from_sortable(center_bounds[3 + axis]) - half_lower[axis];
    scale[axis] = cells_per_length(h, grid_bits);
  }
}

void fill_bins(Task task) {
  const uint lane = gl_LocalInvocationID.x;
  for (uint b = lane; b < 3 * bins; b += gl_WorkGroupSize.x) {
    for (uint k = 0; k < 6; ++k) bin_bounds[6 * b + k] = k < 3 ? ~0u : 0u;
    bin_treelets[b] = 0;
    bin_leaves[b] = 0;
    bin_triangles[b] = 0;
  }
  barrier();
  for (uint i = task.begin + lane; i < task.end; i += gl_WorkGroupSize.x) {
    const uint t = push.from.at[i];
    const Box box = push.roots.at[t].box;
    const uvec3 bin = bins_of(box);
    const uint leaves = leaves_of(t);
    const uint triangles = triangles_of(t);
    for (uint axis = 0; axis < 3; ++axis) {
      const uint b = axis * bins + bin[axis];
      for (uint k = 0; k < 3; ++k) {
        atomicMin(bin_bounds[6 * b + k], sortable(box.lower[k]));
        atomicMax(bin_bounds[6 * b + 3 + k], sortable(box.upper[k]));
      }
      atomicAdd(bin_treelets[b], 1);
      atomicAdd(bin_leaves[b], leaves);
      atomicAdd(bin_triangles[b], triangles);
    }
  }
  barrier();
}

Side add_bin(Side side, uint b) {
  for (uint k = 0; k < 3; ++k) {
    side.bounds[k] = min(side.bounds[k], bin_bounds[6 * b + k]);
    side.bounds[3 + k] = max(side.bounds[3 + k], bin_bounds[6 * b + 3 + k]);
  }
  side.treelets += bin_treelets[b];
  side.leaves += bin_leaves[b];
  side.triangles += bin_triangles[b];
  return side;
}

// Infinite where there are no treelets.
float cost_of(Side side) {
  if (side.treelets == 0) return uintBitsToFloat(0x7f800000u);
  vec3 e;
  for (uint k = 0; k < 3; ++k) e[k] = from_sortable(side.bounds[3 + k]) - from_sortable(side.bounds[k]);
  precise const float area = (e.x * e.y + e.y * e.z) + e.z * e.x;
  precise const float cost = area * float(side.triangles);
  return cost;
}

// Sweeps over the bins of an axis, from right to left, then from left to right, for the split that costs least, of equal ones the
// first; no_split where none counts. Split axis · (bins - 1) + j is behind bin j.
void sweep(uint axis) {
  const Side nothing = Side(uint[6](~0u, ~0u, ~0u, 0, 0, 0), 0, 0, 0);
  Side right = nothing;
  for (uint j = bins - 1; j > 0; --j) {
    right = add_bin(right, axis * bins + j);
    right_costs[axis * bins + j] = cost_of(right);
  }
  Side left = nothing;
  float least = uintBitsToFloat(0x7f800000u);
  uint best = no_split;
  for (uint j = 0; j + 1 < bins; ++j) {
    left = add_bin(left, axis * bins + j);
    precise const float cost = cost_of(left) + right_costs[axis * bins + j + 1];
    if (!(cost < least)) continue;  // neither where it is no number
    least = cost;
    best = axis * (bins - 1) + j;
    axis_left[axis][0] = left.treelets;
    axis_left[axis][1] = left.leaves;
    axis_left[axis][2] = left.triangles;
  }
  axis_costs[axis] = least;
  axis_splits[axis] = best;
  left = add_bin(left, axis * bins + bins - 1);
  if (axis == 0) node_bounds = left.bounds;
}

// The best of the three axes; without any the first half of the treelets goes left.
uint best_split(Task task) {
  const uint lane = gl_LocalInvocationID.x;
  for (uint axis = lane; axis < 3; axis += gl_WorkGroupSize.x) sweep(axis);
  barrier();
  uint best = 0;
  for (uint axis = 1; axis < 3; ++axis) {
    if (axis_costs[axis] < axis_costs[best]) best = axis;
  }
  const uint split = axis_splits[best];
  const uint half_count = (task.end - task.begin) / 2;
  if (lane == 0) {
    left_treelets = split == no_split ? half_count : axis_left[best][0];
    left_leaves = split == no_split ? 0 : axis_left[best][1];
    left_triangles = split == no_split ? 0 : axis_left[best][2];
  }
  barrier();
  if (split == no_split) {
    for (uint i = task.begin + lane; i < task.begin + half_count; i += gl_WorkGroupSize.x) {
      atomicAdd(left_leaves, leaves_of(push.from.at[i]));
      atomicAdd(left_triangles, triangles_of(push.from.at[i]));
    }
  }
  barrier();
  return split;
}

bool goes_left(Task task, uint split, uint i) {
  if (split == no_split) return i - task.begin < (task.end - task.begin) / 2;
  const uvec3 bin = bins_of(push.roots.at[push.from.at[i]].box);
  return bin[split / (bins - 1)] <= split % (bins - 1);
}

// Moves the treelets to their side, in order; a side of one is done.
void move(Task task, uint split, Task left, Task right) {
  const uint lane = gl_LocalInvocationID.x;
  uint lefts = 0;
  for (uint begin = task.begin; begin < task.end; begin += gl_WorkGroupSize.x) {
    const uint i = begin + lane;
    const bool is_left = i < task.end && goes_left(task, split, i);
    uint total;
    const uint before = lefts + sum_before(is_left ? 1 : 0, total);
    if (i < task.end) {
      const uint t = push.from.at[i];
      push.to.at[is_left ? left.begin + before : right.begin + (i - task.begin) - before] = t;
      const Task side = is_left ? left : right;
      if (side.end - side.begin == 1) push.places.at[t] = Place(side.slot, side.leaf, side.triangle);
    }
    lefts += total;
  }
}

void add_task(Task task) {
  if (task.end - task.begin == 1) return;
  push.next_tasks.at[atomicAdd(push.queues.at[1 - push.level].count, 1)] = task;
}

void main() {
  const uint count = push.queues.at[push.level].count;
  for (uint index = group_index(); index < count; index += gl_NumWorkGroups.x * gl_NumWorkGroups.y) {
    const Task task = push.tasks.at[index];
    find_grid(task);
    barrier();
    fill_bins(task);
    const uint split = best_split(task);
    const uint children = 2 * (task.leaf + left_leaves);
    const uint middle = task.begin + left_treelets;
    const Task left = Task(children, task.begin, middle, task.leaf, task.triangle);
    const Task right = Task(children + 1, middle, task.end, task.leaf + left_leaves, task.triangle + left_triangles);
    move(task, split, left, right);
    if (gl_LocalInvocationID.x == 0) {
      Box box;
      for (uint k = 0; k < 3; ++k) {
        box.lower[k] = from_sortable(node_bounds[k]);
        box.upper[k] = from_sortable(node_bounds[3 + k]);
      }
      push.nodes.at[task.slot] = Node(box, children, 0);
      add_task(left);
      add_task(right);
    }
    barrier();
  }
}
