// From what hemicubes see to sparse rows of form factors. A work-item sums a row in a dense array of its own.
#include "lib/chunk.h"
#include "shared/radiosity_types.h"

static inline uint cells_of(const HemicubeParams* cube) {
  return 3 * cube->resolution * cube->resolution * cube->divisions * cube->divisions;
}

// counts[row] = different sides that the row's rays meet, and reached[side] = 1 for each of them. `sums`: side_count
// integers an item, zero before and after. Launch: G items.
kernel void radiosity_count_row(global const uint* restrict seen, global ulong* restrict sums,
                                global uint* restrict counts, global uint* restrict reached,
                                const HemicubeParams cube) {
  const uint g = (uint)get_global_id(0), groups = (uint)get_global_size(0), cells = cells_of(&cube);
  global ulong* mark = sums + (ulong)g * cube.side_count;
  const uint end = chunk_begin(cube.row_count, g + 1, groups);
  for (uint row = chunk_begin(cube.row_count, g, groups); row < end; row++) {
    global const uint* ids = seen + row * cells;
    uint count = 0;
    for (uint i = 0; i < cells; i++) {
      if (ids[i] == HR_NO_SIDE || mark[ids[i]] != 0) continue;
      mark[ids[i]] = 1;
      count++;
      atomic_or(&reached[ids[i]], 1u);
    }
    for (uint i = 0; i < cells; i++) {
      if (ids[i] != HR_NO_SIDE) mark[ids[i]] = 0;
    }
    counts[row] = count;
  }
}

// Row `row` becomes columns and values [starts[row], starts[row + 1]), columns ascending; a value is the sum of the
// cells' form factors `delta`, of a top (n x n) and of one face (n x n / 2), over the sample points' mean. Launch: G
// items.
kernel void radiosity_emit_row(global const uint* restrict seen, global ulong* restrict sums,
                               global const uint* restrict starts, global const uint* restrict delta,
                               global uint* restrict columns, global float* restrict values,
                               const HemicubeParams cube) {
  const uint g = (uint)get_global_id(0), groups = (uint)get_global_size(0);
  const uint n = cube.resolution, top = n * n, face = n * n / 2, samples = cube.divisions * cube.divisions;
  global ulong* sum = sums + (ulong)g * cube.side_count;
  const uint end = chunk_begin(cube.row_count, g + 1, groups);
  const float unit = 1.0f / (float)(1ul << HR_CELL_UNITS_LOG2) / (float)samples;
  for (uint row = chunk_begin(cube.row_count, g, groups); row < end; row++) {
    for (uint sample = 0; sample < samples; sample++) {
      global const uint* ids = seen + (row * samples + sample) * 3 * top;
      for (uint i = 0; i < 3 * top; i++) {
        if (ids[i] != HR_NO_SIDE) sum[ids[i]] += delta[i < top ? i : top + (i - top) % face];
      }
    }
    uint at = starts[row];
    for (uint side = 0; side < cube.side_count && at < starts[row + 1]; side++) {
      if (sum[side] == 0) continue;
      columns[at] = side;
      values[at++] = (float)sum[side] * unit;
      sum[side] = 0;
    }
  }
}
