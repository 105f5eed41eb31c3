// Trees in the form that rays traverse, made on the device from Bvh2 nodes.
#include "methods/vulkan/shaders/scene.glsl"

// A reference to a node: the index of its children's pair, or, with this bit, of the first triangle of a leaf.
const uint leaf_bit = 0x80000000u;
// In a leaf triangle's number: it is the last of its leaf.
const uint last_bit = 0x80000000u;

// Two siblings in 64 bytes (Aila and Laine 2009), in the place of their pair in Bvh2::nodes: axis by axis the lower planes of both
// and the upper planes of both, then their references. `Bits` reads the same memory 64 bits at a time.
const uint pair_floats = 16;
const uint pair_references = 12;
// A triangle of a leaf in 40 bytes: three corners, and its number.
const uint triangle_words = 10;
const uint triangle_number = 9;

layout(buffer_reference, scalar, buffer_reference_align = 8) readonly buffer Bits { double at[]; };
