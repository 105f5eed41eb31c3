// Clusters of PLOC in Morton order: a box each, and a link, which of a leaf is its place with leaf_bit, of an inner node where its
// children stand. Children stand in pairs in the order of merges, the last first.
#include "methods/vulkan/shaders/scene.glsl"

const uint leaf_bit = 0x80000000u;

// Where a pair of the merged tree goes, and the first triangle below it.
struct Place {
  uint pair;
  uint begin;
};

layout(buffer_reference, scalar, buffer_reference_align = 4) buffer Places { Place at[]; };

Node node_of(Box box, uint link) { return Node(box, link & ~leaf_bit, (link & leaf_bit) != 0 ? 1 : 0); }
