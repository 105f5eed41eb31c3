// Triangles go by the candidates of a workgroup a tile after another.
shared Box tile_boxes[gl_WorkGroupSize.x];
shared uint tile_indices[gl_WorkGroupSize.x];

// Shows n triangles to every candidate. `by_place`: all centers are equal, and places stand for indices.
void test_tiles(Boxes boxes, Uints indices, uint begin, uint n, bool by_place) {
  const uint lane = gl_LocalInvocationID.x;
  for (uint tile = 0; tile < n; tile += gl_WorkGroupSize.x) {
    barrier();
    if (tile + lane < n) {
      const uint index = indices.at[begin + tile + lane];
      tile_boxes[lane] = boxes.at[index];
      tile_indices[lane] = by_place ? tile + lane : index;
    }
    barrier();
    const uint size = min(n - tile, gl_WorkGroupSize.x);
    for (uint i = 0; i < size; ++i) test(tile_boxes[i], by_place ? vec3(0) : box_center(tile_boxes[i]), tile_indices[i]);
  }
}
