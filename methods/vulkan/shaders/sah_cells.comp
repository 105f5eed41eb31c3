#version 460
#extension GL_GOOGLE_include_directive : require
#include "methods/vulkan/shaders/scene.glsl"

// Of triangles in the order of cells, the foremost bits of their Morton codes: where each cell begins, and its box. An
// invocation's triangles stand together.
layout(constant_id = 1) const uint items = 1;  // triangles of an invocation

layout(push_constant, scalar) uniform Push {
  Boxes boxes;
  Uints indices;
  Uints codes;   // 30 bits, in the order of the indices
  Uints starts;  // one more than there are cells
  Uints minima;  // of the boxes: three a cell, begun as ones
  Uints maxima;  // three a cell, begun as zeros
  uint count;
  uint levels;  // bits of a cell
} push;

uint cell_of_place(uint place) { return push.codes.at[place] >> 30 - push.levels; }

void extend(uint cell, Box box) {
  for (uint axis = 0; axis < 3; ++axis) {
    atomicMin(push.minima.at[3 * cell + axis], sortable(box.lower[axis]));
    atomicMax(push.maxima.at[3 * cell + axis], sortable(box.upper[axis]));
  }
}

void main() {
  const uint begin = min(invocation_index() * items, push.count);
  const uint end = min(begin + items, push.count);
  if (begin == end) return;
  uint next = begin == 0 ? 0 : cell_of_place(begin - 1) + 1;  // the first cell that has not begun yet
  uint cell = cell_of_place(begin);
  Box box = empty_box();
  for (uint i = begin; i < end; ++i) {
    const uint its = cell_of_place(i);
    if (its != cell) {
      extend(cell, box);
      box = empty_box();
      cell = its;
    }
    box = united(box, push.boxes.at[push.indices.at[i]]);
    for (; next <= cell; ++next) push.starts.at[next] = i;
  }
  extend(cell, box);
  if (end == push.count) {
    for (; next <= 1u << push.levels; ++next) push.starts.at[next] = push.count;
  }
}
