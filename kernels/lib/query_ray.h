// One query ray against the tree: what single-ray queries ask, and packets whose rays cannot go together.
#ifndef HR_LIB_QUERY_RAY_H
#define HR_LIB_QUERY_RAY_H

#include "lib/traverse.h"

static inline Ray query_ray(QueryRay q) {
  return make_ray((real3)(q.origin.x, q.origin.y, q.origin.z), (real3)(q.direction.x, q.direction.y, q.direction.z),
                  q.origin.w, q.direction.w);
}

static inline QueryHit query_closest(const SceneView* view, QueryRay q) {
  const Ray ray = query_ray(q);
  const Skip skip = {HR_NO_PRIMITIVE, 1, 0};
  const Hit hit = traverse_closest(view, &ray, &skip);
  const QueryHit result = {(float)hit.t, (float)hit.u, (float)hit.v, hit.primitive};
  return result;
}

static inline uint query_any(const SceneView* view, QueryRay q) {
  const Ray ray = query_ray(q);
  const Skip skip = {HR_NO_PRIMITIVE, 1, 0};
  return traverse_any(view, &ray, &skip) ? 1u : 0u;
}

#endif
