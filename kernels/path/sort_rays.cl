// Incoherent rays in an order that finds the tree in the cache: a run of the queue is sorted by where the rays start
// and which way they go.
#include "lib/chunk.h"
#include "lib/ray_code.h"

// keys[i] = code of the ray in queue[first + i], above its slot. Launch: G items.
kernel void path_code_rays(global const real4* restrict path_ray_origin,
                           global const real4* restrict path_ray_direction, global const uint* restrict queue,
                           const uint first, const uint count, const float4 lo, const float4 scale,
                           const uint index_bits, global ulong* restrict keys) {
  const uint g = (uint)get_global_id(0), groups = (uint)get_global_size(0);
  for (uint i = chunk_begin(count, g, groups); i < chunk_begin(count, g + 1, groups); i++) {
    const uint slot = queue[first + i];
    const real4 o = path_ray_origin[slot], d = path_ray_direction[slot];
    const float4 origin = (float4)((float)o.x, (float)o.y, (float)o.z, 0.0f);
    const float4 direction = (float4)((float)d.x, (float)d.y, (float)d.z, 0.0f);
    keys[i] = (ulong)ray_code(origin, direction, lo, scale) << index_bits | slot;
  }
}

// queue[first + i] = slot of sorted key i. Launch: G items.
kernel void path_order_queue(global const ulong* restrict keys, const uint index_bits, global uint* restrict queue,
                             const uint first, const uint count) {
  const uint g = (uint)get_global_id(0), groups = (uint)get_global_size(0);
  for (uint i = chunk_begin(count, g, groups); i < chunk_begin(count, g + 1, groups); i++) {
    queue[first + i] = (uint)(keys[i] & ((1ul << index_bits) - 1));
  }
}
