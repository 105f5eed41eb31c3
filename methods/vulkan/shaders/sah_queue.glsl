// Queues of nodes to be split: `from` of a level, and the two children of each, which what is decided of the split takes the place of
// until they are there.
const uint no_split = 0;
const uint is_split = 8;     // and the axis: of 3 the triangles stay in their order
const uint at_triangle = 4;  // the second word is the triangle at whose center it is; else it is the position

const uint no_child = 0x7fffffffu;  // nothing to be split there
const uint is_small = 0x80000000u;  // set of nodes for the small-split kernel

// A node of n triangles as a queue has it. `small`: the most triangles for the small-split kernel.
uint queued(uint number, uint n, uint small) { return n < 2 ? no_child : number | (n <= small ? is_small : 0); }
