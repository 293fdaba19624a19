// Exclusive prefix sum of a short array (a histogram of chunks): one work-item, in place.

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
