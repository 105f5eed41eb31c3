// The best candidate of a workgroup that splits one node.
shared uint least_cost;  // as bits: costs are not negative
shared uint least_rank;  // of those of least cost

// Finds the least cost, once the candidates have seen the n triangles. To be called by all invocations.
float compare_candidates(uint n) {
  barrier();
  if (gl_LocalInvocationID.x == 0) {
    least_cost = floatBitsToUint(infinity);
    least_rank = ~0u;
  }
  barrier();
  for (uint k = 0; k < own; ++k) {
    set_cost(k, n);
    if (candidates[k].cost < infinity) atomicMin(least_cost, floatBitsToUint(candidates[k].cost));
  }
  barrier();
  const float least = uintBitsToFloat(least_cost);
  for (uint k = 0; k < own; ++k) {
    if (candidates[k].cost == least && least < infinity) atomicMin(least_rank, rank_of(k, n, number_of(k)));
  }
  barrier();
  return least;
}

bool is_best(uint k, uint n) {
  return candidates[k].cost < infinity && candidates[k].cost == uintBitsToFloat(least_cost) &&
         rank_of(k, n, number_of(k)) == least_rank;
}
