// Stage: the closest hit of the path's current ray.
#ifndef HR_PATH_INTERSECT_CLOSEST_H
#define HR_PATH_INTERSECT_CLOSEST_H

#include "lib/traverse.h"
#include "path/path_context.h"

static inline uint stage_intersect_closest(const PathContext* context, PathState* s) {
  const Ray ray = make_ray(xyz(s->ray_origin), xyz(s->ray_direction), 0, INFINITY);
  const Skip skip = {s->ray_skip, 1, 0};
  const Hit hit = traverse_closest(&context->view, &ray, &skip);
  s->hit = (real4)(hit.t, hit.u, hit.v, 0);
  s->hit_primitive = hit.primitive;
  return hit.primitive == HR_NO_PRIMITIVE ? HR_STAGE_shade_miss : HR_STAGE_shade_surface;
}

#endif
