// Compaction: after every round the live slots are sorted by their next stage, so that each stage runs over a dense run
// of the queue. Count, scan (parallel/scan.cl), emit: stable, hence the same order on every run and device.
#include "shared/stages.def"

// One chunk of the queue: item g of G takes [n g / G, n (g+1) / G).
static inline uint queue_chunk_begin(uint n, uint g, uint groups) { return (uint)((ulong)n * g / groups); }

// counts[stage * G + g] = entries of chunk g that go to `stage`. Launch: G items.
kernel void path_queue_count(global const uint* restrict queue, global const uint* restrict next_stage,
                             global uint* restrict counts, const uint count) {
  const uint g = (uint)get_global_id(0), groups = (uint)get_global_size(0);
  uint histogram[HR_STAGE_done];
  for (uint s = 0; s < HR_STAGE_done; s++) histogram[s] = 0;
  for (uint i = queue_chunk_begin(count, g, groups); i < queue_chunk_begin(count, g + 1, groups); i++) {
    const uint stage = next_stage[queue[i]];
    if (stage < HR_STAGE_done) histogram[stage]++;
  }
  for (uint s = 0; s < HR_STAGE_done; s++) counts[s * groups + g] = histogram[s];
}

// Writes every live slot to its place in queue_out; offsets = counts after an exclusive scan. Launch: G items.
kernel void path_queue_emit(global const uint* restrict queue, global const uint* restrict next_stage,
                            global const uint* restrict offsets, global uint* restrict queue_out, const uint count) {
  const uint g = (uint)get_global_id(0), groups = (uint)get_global_size(0);
  uint place[HR_STAGE_done];
  for (uint s = 0; s < HR_STAGE_done; s++) place[s] = offsets[s * groups + g];
  for (uint i = queue_chunk_begin(count, g, groups); i < queue_chunk_begin(count, g + 1, groups); i++) {
    const uint slot = queue[i];
    const uint stage = next_stage[slot];
    if (stage < HR_STAGE_done) queue_out[place[stage]++] = slot;
  }
}
