// What the items of a work-group do together, in local memory. Every item of the group must call these.
#ifndef HR_LIB_GROUP_H
#define HR_LIB_GROUP_H

#ifndef HR_LOCAL_SIZE
#define HR_LOCAL_SIZE 64
#endif

// The sum of `value` over the items before this one (Hillis and Steele 1986); *total: over all. `sums` has
// HR_LOCAL_SIZE elements, which are free again on return. Sums wrap.
static inline ulong group_exclusive_scan(local ulong* sums, ulong value, ulong* total) {
  const uint i = (uint)get_local_id(0);
  sums[i] = value;
  barrier(CLK_LOCAL_MEM_FENCE);
  for (uint step = 1; step < HR_LOCAL_SIZE; step *= 2) {
    const ulong before = i >= step ? sums[i - step] : 0;
    barrier(CLK_LOCAL_MEM_FENCE);
    sums[i] += before;
    barrier(CLK_LOCAL_MEM_FENCE);
  }
  const ulong up_to_here = sums[i];
  *total = sums[HR_LOCAL_SIZE - 1];
  barrier(CLK_LOCAL_MEM_FENCE);
  return up_to_here - value;
}

#endif
