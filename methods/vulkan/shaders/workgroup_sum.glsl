// Prefix sums over the invocations of a workgroup, whatever its size and that of its subgroups.
shared uint workgroup_sums[gl_WorkGroupSize.x];

// The sum over the invocations before this one; `total`: over all. To be called by all of them.
uint sum_before(uint value, out uint total) {
  const uint lane = gl_LocalInvocationID.x;
  workgroup_sums[lane] = value;
  barrier();
  for (uint distance = 1; distance < gl_WorkGroupSize.x; distance *= 2) {
    const uint before = lane >= distance ? workgroup_sums[lane - distance] : 0;
    barrier();
    workgroup_sums[lane] += before;
    barrier();
  }
  total = workgroup_sums[gl_WorkGroupSize.x - 1];
  const uint sum = workgroup_sums[lane] - value;
  barrier();  // it may be called again
  return sum;
}
