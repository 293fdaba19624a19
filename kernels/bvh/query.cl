// Ray queries against a built tree, for arrays of rays, one ray at a time: in the order given, or sorted, so that rays
// which start close together and go the same way follow each other and find the tree in the cache.
#include "lib/chunk.h"
#include "lib/query_ray.h"

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

static inline uint interleave(uint4 cell, uint axis_bits) {
  uint code = 0;
  for (uint b = axis_bits; b-- > 0;) {
    code = code << 3 | (cell.x >> b & 1u) << 2 | (cell.y >> b & 1u) << 1 | (cell.z >> b & 1u);
  }
  return code;
}

// keys[i] = (cell of the origin in the scene's bounds, 4 bits an axis; cell of the direction, 3 bits an axis) above i.
// scale = cells per metre. Launch: G items.
kernel void query_code_rays(global const QueryRay* restrict rays, const uint count, const float4 lo, const float4 scale,
                            const uint index_bits, global ulong* restrict keys) {
  const uint g = (uint)get_global_id(0), groups = (uint)get_global_size(0);
  const uint end = chunk_begin(count, g + 1, groups);
  for (uint i = chunk_begin(count, g, groups); i < end; i++) {
    const float4 d = rays[i].direction;
    const float largest = max(max(fabs(d.x), fabs(d.y)), fabs(d.z));
    const float4 from = max((float4)(0.0f), min((float4)(15.0f), (rays[i].origin - lo) * scale));
    const float4 way = max((float4)(0.0f), min((float4)(7.0f), (d / largest) * 4.0f + 4.0f));
    const uint code = interleave(convert_uint4(from), 4) << 9 | interleave(convert_uint4(way), 3);
    keys[i] = (ulong)code << index_bits | i;
  }
}
