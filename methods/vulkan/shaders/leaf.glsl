// The node of a leaf over triangles in Morton order.
Node leaf_node(Boxes boxes, Uints order, Uints leaf_first, uint leaf) {
  if (one_a_leaf) return Node(boxes.at[order.at[leaf]], leaf, 1);
  const uint begin = leaf_first.at[leaf];
  const uint end = leaf_first.at[leaf + 1];
  Box box = empty_box();
  for (uint i = begin; i < end; ++i) box = united(box, boxes.at[order.at[i]]);
  return Node(box, begin, end - begin);
}
