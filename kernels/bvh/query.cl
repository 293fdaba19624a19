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

// hits[i] = closest hit of rays[i]. Launch: count / HR_RAYS_PER_ITEM items, rounded up to the local size.
kernel __attribute__((reqd_work_group_size(HR_LOCAL_SIZE, 1, 1))) void query_intersect(
    HR_SCENE_PARAMETERS global const QueryRay* restrict rays, global QueryHit* restrict hits, const uint count,
    const RenderParams params) {
  const uint first = (uint)get_global_id(0) * HR_RAYS_PER_ITEM;
  HR_MAKE_SCENE_VIEW(params)
  for (uint i = first; i < min(count, first + HR_RAYS_PER_ITEM); i++) hits[i] = query_closest(&view, rays[i]);
}

// occluded[i] = 1 if rays[i] meets anything, else 0. Launch: as query_intersect.
kernel __attribute__((reqd_work_group_size(HR_LOCAL_SIZE, 1, 1))) void query_occluded(
    HR_SCENE_PARAMETERS global const QueryRay* restrict rays, global uint* restrict occluded, const uint count,
    const RenderParams params) {
  const uint first = (uint)get_global_id(0) * HR_RAYS_PER_ITEM;
  HR_MAKE_SCENE_VIEW(params)
  for (uint i = first; i < min(count, first + HR_RAYS_PER_ITEM); i++) occluded[i] = query_any(&view, rays[i]);
}

// The same in the order of sorted keys, whose low index_bits name the ray. Launch: as query_intersect.
kernel __attribute__((reqd_work_group_size(HR_LOCAL_SIZE, 1, 1))) void query_intersect_sorted(
    HR_SCENE_PARAMETERS global const QueryRay* restrict rays, global QueryHit* restrict hits, const uint count,
    const RenderParams params, global const ulong* restrict keys, const uint index_bits) {
  const uint first = (uint)get_global_id(0) * HR_RAYS_PER_ITEM;
  HR_MAKE_SCENE_VIEW(params)
  for (uint k = first; k < min(count, first + HR_RAYS_PER_ITEM); k++) {
    const uint i = (uint)(keys[k] & ((1ul << index_bits) - 1));
    hits[i] = query_closest(&view, rays[i]);
  }
}

kernel __attribute__((reqd_work_group_size(HR_LOCAL_SIZE, 1, 1))) void query_occluded_sorted(
    HR_SCENE_PARAMETERS global const QueryRay* restrict rays, global uint* restrict occluded, const uint count,
    const RenderParams params, global const ulong* restrict keys, const uint index_bits) {
  const uint first = (uint)get_global_id(0) * HR_RAYS_PER_ITEM;
  HR_MAKE_SCENE_VIEW(params)
  for (uint k = first; k < min(count, first + HR_RAYS_PER_ITEM); k++) {
    const uint i = (uint)(keys[k] & ((1ul << index_bits) - 1));
    occluded[i] = query_any(&view, rays[i]);
  }
}

// keys[i] = code of rays[i] (lib/ray_code.h) above i. Launch: G items.
kernel void query_code_rays(global const QueryRay* restrict rays, const uint count, const float4 lo, const float4 scale,
                            const uint index_bits, global ulong* restrict keys) {
  const uint g = (uint)get_global_id(0), groups = (uint)get_global_size(0);
  const uint end = chunk_begin(count, g + 1, groups);
  for (uint i = chunk_begin(count, g, groups); i < end; i++) {
    keys[i] = (ulong)ray_code(rays[i].origin, rays[i].direction, lo, scale) << index_bits | i;
  }
}
