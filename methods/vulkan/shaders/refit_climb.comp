#version 460
#extension GL_GOOGLE_include_directive : require
#include "methods/vulkan/shaders/refit.glsl"

// From every leaf up: of the invocations that come to a pair of siblings the first stops, the second goes on with their parent
// (Karras 2012, Section 4), and leaves the pair's mark as it was.
layout(constant_id = 1) const bool fences = true;  // device_shape.h

layout(buffer_reference, scalar, buffer_reference_align = 32) coherent buffer SharedNodes { Node at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) coherent buffer Arrivals { uint at[]; };

layout(push_constant, scalar) uniform Push {
  SharedNodes nodes;
  Vertices vertices;
  Triangles corners;
  Uints leaves;   // the nodes that are leaves
  Uints parents;  // of each pair the node that it is below
  Arrivals arrivals;
  uint count;
} push;

void main() {
  const uint i = invocation_index();
  if (i >= push.count) return;
  uint n = push.leaves.at[i];
  Box box = leaf_box(push.vertices, push.corners, push.nodes.at[n].first, push.nodes.at[n].count);
  push.nodes.at[n].box = box;
  while (n != 0) {
    if (fences) memoryBarrierBuffer();
    if (atomicXor(push.arrivals.at[n / 2], 1) == 0) return;
    if (fences) memoryBarrierBuffer();
    const Box sibling = push.nodes.at[n ^ 1].box;
    if ((n & 1) == 0) {
      box = united(box, sibling);
    } else {
      box = united(sibling, box);
    }
    n = push.parents.at[n / 2];
    push.nodes.at[n].box = box;
  }
}
