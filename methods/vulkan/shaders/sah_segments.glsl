// Large nodes are split by several workgroups, one a segment of their triangles, that bring together what they found.
layout(constant_id = 3) const uint segment_size = 1;  // most triangles of a segment

// First place and end of a segment of a node of n triangles. None crosses the middle of the node.
uvec2 segment_range(uint segment, uint n) {
  const uint middle = n / 2;
  const uint lefts = (middle + segment_size - 1) / segment_size;
  if (segment < lefts) return uvec2(segment * segment_size, min((segment + 1) * segment_size, middle));
  const uint begin = middle + (segment - lefts) * segment_size;
  return uvec2(begin, min(begin + segment_size, n));
}

// What the segments of a node found: bounds of the centers, and of each candidate its count and boxes; behind the candidates those
// of the node's halves. Minima in one block, begun as ones, maxima and counts in another, begun as zeros.
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer Minima {
  uint center[3];
  uint at[];  // of the left box, of the right box: six a candidate
};
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer Maxima {
  uint center[3];
  uint at[];  // the same, then the count: seven
};

// How a large node is split, for the kernels and the host after it.
struct Result {
  uint lefts;   // 0: it is a leaf
  uint axis;    // no_axis: the triangles stay in their order
  float position;
  uint index;
};
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer Results { Result at[]; };
