// Treelets, and the tree over them: methods/lbvh/README.md, 6 and 7.
#include "methods/vulkan/shaders/scene.glsl"

// A node over several treelets: begin to end of those in the order of its level.
struct Task {
  uint slot;  // where the node goes
  uint begin;
  uint end;
  uint leaf;      // leaves of the finished tree before it
  uint triangle;  // triangles before it
};

// Where a treelet goes: its root, its first leaf, its first triangle.
struct Place {
  uint slot;
  uint leaf;
  uint triangle;
};

// Tasks of a level, and workgroups for them.
struct Queue {
  uvec3 groups;
  uint count;
};

layout(buffer_reference, scalar, buffer_reference_align = 4) buffer Tasks { Task at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer Places { Place at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer Queues { Queue at[]; };
