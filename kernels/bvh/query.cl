// Ray queries against a built tree, for arrays of rays.
#include "lib/traverse.h"

#ifndef HR_LOCAL_SIZE
#define HR_LOCAL_SIZE 64
#endif

static inline Ray query_ray(QueryRay q) {
  return make_ray((real3)(q.origin.x, q.origin.y, q.origin.z), (real3)(q.direction.x, q.direction.y, q.direction.z),
                  q.origin.w, q.direction.w);
}

// hits[i] = closest hit of rays[i]. Launch: count items, rounded up to the local size.
kernel __attribute__((reqd_work_group_size(HR_LOCAL_SIZE, 1, 1))) void query_intersect(
    HR_SCENE_PARAMETERS global const QueryRay* restrict rays, global QueryHit* restrict hits, const uint count,
    const RenderParams params) {
  const uint i = (uint)get_global_id(0);
  if (i >= count) return;
  HR_MAKE_SCENE_VIEW(params)
  const Ray ray = query_ray(rays[i]);
  const Skip skip = {HR_NO_PRIMITIVE, 1, 0};
  const Hit hit = traverse(&view, &ray, &skip, false);
  QueryHit result;
  result.t = (float)hit.t;
  result.u = (float)hit.u;
  result.v = (float)hit.v;
  result.primitive = hit.primitive;
  hits[i] = result;
}

// occluded[i] = 1 if rays[i] meets anything, else 0. Launch: count items, rounded up to the local size.
kernel __attribute__((reqd_work_group_size(HR_LOCAL_SIZE, 1, 1))) void query_occluded(
    HR_SCENE_PARAMETERS global const QueryRay* restrict rays, global uint* restrict occluded, const uint count,
    const RenderParams params) {
  const uint i = (uint)get_global_id(0);
  if (i >= count) return;
  HR_MAKE_SCENE_VIEW(params)
  const Ray ray = query_ray(rays[i]);
  const Skip skip = {HR_NO_PRIMITIVE, 1, 0};
  const Hit hit = traverse(&view, &ray, &skip, true);
  occluded[i] = hit.primitive != HR_NO_PRIMITIVE ? 1u : 0u;
}
