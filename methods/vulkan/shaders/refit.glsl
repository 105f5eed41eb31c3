// Boxes of nodes from what is below them, as harness/accel/refit.cpp makes them.
#include "methods/vulkan/shaders/scene.glsl"

// The box of a leaf's triangles, whose corners are listed leaf by leaf.
Box leaf_box(Vertices vertices, Triangles corners, uint first, uint count) {
  Box box = empty_box();
  for (uint i = first; i < first + count; ++i) {
    const uvec3 triangle = corners.at[i];
    for (uint k = 0; k < 3; ++k) {
      const vec3 p = vertices.at[triangle[k]];
      box = united(box, Box(p, p));
    }
  }
  return box;
}
