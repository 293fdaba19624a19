// Ray queries against a built tree, for arrays of rays, one ray at a time: in the order given, or sorted, so that rays
// which start close together and go the same way follow each other and find the tree in the cache.
#include "lib/chunk.h"
#include "lib/query_ray.h"
#include "lib/ray_code.h"

#ifndef HR_LOCAL_SIZE
#define HR_LOCAL_SIZE 64
#endif
#ifndef HR_RAYS_PER_ITEM
#define HR_RAYS_PER_ITEM 1
#endif

// results[i] = query(rays[i]), for the rays in the order given or in that of sorted keys, whose low index_bits name the
// ray. Launch: count / HR_RAYS_PER_ITEM items, rounded up to the local size.
#define HR_QUERY_KERNEL(name, Result, results, query, order_parameters, ray_at_k)                                  \
  kernel __attribute__((reqd_work_group_size(HR_LOCAL_SIZE, 1, 1))) void name(                                     \
      HR_SCENE_PARAMETERS global const QueryRay* restrict rays, global Result* restrict results, const uint count, \
      const RenderParams params order_parameters) {                                                                \
    const uint first = (uint)get_global_id(0) * HR_RAYS_PER_ITEM;                                                  \
    HR_MAKE_SCENE_VIEW(params)                                                                                     \
    for (uint k = first; k < min(count, first + HR_RAYS_PER_ITEM); k++) {                                          \
      const uint i = ray_at_k;                                                                                     \
      results[i] = query(&view, rays[i]);                                                                          \
    }                                                                                                              \
  }
#define HR_SORTED_PARAMETERS , global const ulong *restrict keys, const uint index_bits
#define HR_SORTED_RAY ((uint)(keys[k] & ((1ul << index_bits) - 1)))

// The closest hits.
HR_QUERY_KERNEL(query_intersect, QueryHit, hits, query_closest, , k)
HR_QUERY_KERNEL(query_intersect_sorted, QueryHit, hits, query_closest, HR_SORTED_PARAMETERS, HR_SORTED_RAY)
// 1 for rays that meet anything, else 0.
HR_QUERY_KERNEL(query_occluded, uint, occluded, query_any, , k)
HR_QUERY_KERNEL(query_occluded_sorted, uint, occluded, query_any, HR_SORTED_PARAMETERS, HR_SORTED_RAY)

// keys[i] = code of rays[i] (lib/ray_code.h) above i. Launch: G items.
kernel void query_code_rays(global const QueryRay* restrict rays, const uint count, const float4 lo, const float4 scale,
                            const uint index_bits, global ulong* restrict keys) {
  const uint g = (uint)get_global_id(0), groups = (uint)get_global_size(0);
  const uint end = chunk_begin(count, g + 1, groups);
  for (uint i = chunk_begin(count, g, groups); i < end; i++) {
    keys[i] = (ulong)ray_code(rays[i].origin, rays[i].direction, lo, scale) << index_bits | i;
  }
}
