// Exclusive prefix sums of short arrays (histograms of chunks), in place: by one work-item, which is what CPUs like, or
// by a work-group.
#include "lib/group.h"

// values[i] becomes the sum of the values before it; values[count] the total. Launch: 1 item.
kernel void parallel_scan(global uint* restrict values, const uint count) {
  uint sum = 0;
  for (uint i = 0; i < count; i++) {
    const uint value = values[i];
    values[i] = sum;
    sum += value;
  }
  values[count] = sum;
}

// The same for rows of `count` values and a total each, one behind the other. Launch: a work-group a row.
kernel __attribute__((reqd_work_group_size(HR_LOCAL_SIZE, 1, 1))) void parallel_scan_rows(global uint* restrict values,
                                                                                          const uint count) {
  local ulong sums[HR_LOCAL_SIZE];
  global uint* row = values + (ulong)get_group_id(0) * (count + 1);
  const uint item = (uint)get_local_id(0);
  uint sum = 0;
  for (uint first = 0; first < count; first += HR_LOCAL_SIZE) {
    const uint i = first + item;
    ulong total;
    const uint before = (uint)group_exclusive_scan(sums, i < count ? row[i] : 0, &total);
    if (i < count) row[i] = sum + before;
    sum += (uint)total;
  }
  if (item == 0) row[count] = sum;
}
