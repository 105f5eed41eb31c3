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
shared float costs[gl_WorkGroupSize.x];
shared uint splits[gl_WorkGroupSize.x];
// Of the left side.
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

// What is in the bins begin to end of an axis.
Side side_of(uint axis, uint begin, uint end) {
  Side side = Side(uint[6](~0u, ~0u, ~0u, 0, 0, 0), 0, 0, 0);
  for (uint b = axis * bins + begin; b < axis * bins + end; ++b) {
    for (uint k = 0; k < 3; ++k) {
      side.bounds[k] = min(side.bounds[k], bin_bounds[6 * b + k]);
      side.bounds[3 + k] = max(side.bounds[3 + k], bin_bounds[6 * b + 3 + k]);
    }
    side.treelets += bin_treelets[b];
    side.leaves += bin_leaves[b];
    side.triangles += bin_triangles[b];
  }
  return side;
}

float cost_of(Side side) {
  vec3 e;
  for (uint k = 0; k < 3; ++k) e[k] = from_sortable(side.bounds[3 + k]) - from_sortable(side.bounds[k]);
  precise const float area = (e.x * e.y + e.y * e.z) + e.z * e.x;
  precise const float cost = area * float(side.triangles);
  return cost;
}

// The number of the split that costs least, of equal ones the first; no_split where none counts. Split axis · (bins - 1) + j is
// behind bin j.
uint best_split() {
  const uint lane = gl_LocalInvocationID.x;
  float least = uintBitsToFloat(0x7f800000u);
  uint best = no_split;
  for (uint s = lane; s < no_split; s += gl_WorkGroupSize.x) {
    const uint axis = s / (bins - 1);
    const uint end = s % (bins - 1) + 1;
    const Side left = side_of(axis, 0, end);
    const Side right = side_of(axis, end, bins);
    if (left.treelets == 0 || right.treelets == 0) continue;
    precise const float cost = cost_of(left) + cost_of(right);
    if (!(cost < least)) continue;  // neither where it is no number
    least = cost;
    best = s;
  }
  costs[lane] = least;
  splits[lane] = best;
  barrier();
  for (uint other = 0; other < gl_WorkGroupSize.x; ++other) {
    if (costs[other] < least || (costs[other] == least && splits[other] < best)) {
      least = costs[other];
      best = splits[other];
    }
  }
  return best;
}

void count_left(Task task, uint split) {
  const uint lane = gl_LocalInvocationID.x;
  const uint half_count = (task.end - task.begin) / 2;
  if (lane == 0) {
    Side left = Side(uint[6](0, 0, 0, 0, 0, 0), half_count, 0, 0);
    if (split != no_split) left = side_of(split / (bins - 1), 0, split % (bins - 1) + 1);
    left_treelets = left.treelets;
    left_leaves = left.leaves;
    left_triangles = left.triangles;
  }
  barrier();
  if (split == no_split) {
    for (uint i = task.begin + lane; i < task.begin + half_count; i += gl_WorkGroupSize.x) {
      atomicAdd(left_leaves, leaves_of(push.from.at[i]));
      atomicAdd(left_triangles, triangles_of(push.from.at[i]));
    }
  }
  barrier();
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
    const uint split = best_split();
    count_left(task, split);
    const uint children = 2 * (task.leaf + left_leaves);
    const uint middle = task.begin + left_treelets;
    const Task left = Task(children, task.begin, middle, task.leaf, task.triangle);
    const Task right = Task(children + 1, middle, task.end, task.leaf + left_leaves, task.triangle + left_triangles);
    move(task, split, left, right);
    if (gl_LocalInvocationID.x == 0) {
      const Side all = side_of(0, 0, bins);
      Box box;
      for (uint k = 0; k < 3; ++k) {
        box.lower[k] = from_sortable(all.bounds[k]);
        box.upper[k] = from_sortable(all.bounds[3 + k]);
      }
      push.nodes.at[task.slot] = Node(box, children, 0);
      add_task(left);
      add_task(right);
    }
    barrier();
  }
}
