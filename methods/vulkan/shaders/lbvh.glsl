// Hierarchies over triangles in Morton order. A "place" is an index in that order. A "split" is numbered by the leaf before it: split k
// parts leaf k from leaf k + 1, and the children of the node that it splits stand at nodes[2k + 2] and nodes[2k + 3]. So where a
// node stands follows from the range of leaves below it, and from the side of its parent on which it is. A node is deeper than
// another if the keys below it have a longer prefix in common; a split's depth is its node's.
layout(constant_id = 2) const bool one_a_leaf = false;  // leaf k is place k, and there is no list of leaves

uint left_slot(uint last) { return 2 * last + 2; }
uint right_slot(uint first) { return 2 * first + 1; }
uint children_of(uint split) { return 2 * split + 2; }

// Bits that two keys (code in two words, then place) have in common from the first on.
uint common_prefix(uvec2 code_a, uvec2 code_b, uint a, uint b) {
  const uvec2 differ = code_a ^ code_b;
  if (differ.y != 0) return 31 - findMSB(differ.y);
  if (differ.x != 0) return 63 - findMSB(differ.x);
  return 95 - findMSB(a ^ b);
}
