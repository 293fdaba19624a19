// Stage: one shadow ray; an unblocked one adds its light, then the next light sample is prepared. Anything blocks,
// glass too: that is Whitted's method, which does not know the refracted way to the light.
#ifndef HR_PATH_INTERSECT_SHADOW_H
#define HR_PATH_INTERSECT_SHADOW_H

#include "lib/traverse.h"
#include "path/light_loop.h"

// The surface's own primitive never blocks it if it is flat; a sphere seen from outside can, but then the light is
// behind its horizon; from within it, and a curved shape, which can be open or hollow, is looked at. A ray of no length
// has been answered (packets.cl).
static inline uint stage_intersect_shadow(const PathContext* context, PathState* s) {
  bool blocked = s->shadow_origin.w < 0;
  if (s->shadow_origin.w > 0) {
    const Ray ray = make_ray(xyz(s->shadow_origin), xyz(s->shadow_direction), 0, s->shadow_origin.w);
    const Skip skip = {shadow_skip(&context->view, s->surface), s->shadow_cursor.z, s->shadow_cursor.w};
    blocked = traverse_any(&context->view, &ray, &skip);
  }
  if (!blocked) path_add(s, xyz(s->shadow_radiance));
  return next_light_sample(context, s);
}

#endif
