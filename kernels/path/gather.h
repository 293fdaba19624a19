// Stage: the final gather. What other surfaces send to the hit is looked for with rays of its own, in place of the
// solution's irradiance there: it has the mesh only in what they meet. What comes from lights is left to the light
// loop, so emission does not count. Then the first light sample.
#ifndef HR_PATH_GATHER_H
#define HR_PATH_GATHER_H

#include "lib/math.h"
#include "lib/rng.h"
#include "lib/traverse.h"
#include "path/light_loop.h"
#include "path/patch_light.h"

// Mean radiance over gather_rays directions about the normal, distributed by the cosine: a (0,2)-sequence that all
// samples of a pixel continue.
static inline real3 gather_radiance(const PathContext* context, const PathState* s) {
  const SceneView* view = &context->view;
  const real3 n = xyz(s->normal), up = xyz(s->shading_normal);
  const real3 axis = fabs(up.x) < REAL(0.5) ? (real3)(1, 0, 0) : (real3)(0, 1, 0);
  const real3 across = normalize3(cross3(axis, up)), along = cross3(up, across);
  const real3 origin = offset_origin(xyz(s->position), xyz(s->position_error), n, n);
  const Skip skip = {s->surface.z, 1, 0};
  const uint4 scramble =
      rng_hash((uint4)(path_pixel(context), 0, s->control.y, HR_DIMENSION_GATHER ^ context->params.seed_key));
  const uint rays = context->params.gather_rays, first = context->params.sample * rays;
  real3 sum = (real3)(0);
  for (uint i = first; i < first + rays; i++) {
    const real u = rng_unit(rng_sobol1(i) ^ scramble.x), radius = square_root(u);
    const real2 turn = sincos_turn(rng_unit(rng_sobol2(i) ^ scramble.y)) * radius;
    real3 direction = across * turn.y + along * turn.x + up * square_root(1 - u);
    // Smooth normals look below the patch, too: there is nothing, so what is above stands for it.
    const real height = dot3(direction, n);
    if (height < 0) direction -= n * (2 * height);
    const Ray ray = make_ray(origin, direction, 0, INFINITY);
    const Hit hit = traverse_closest(view, &ray, &skip);
    if (hit.primitive == HR_NO_PRIMITIVE) continue;
    const Surface met = surface_at(view, origin, direction, &hit);
    sum += diffuse_light(view, &hit, &met);
  }
  return divide3(sum, (real)rays);
}

static inline uint stage_gather(const PathContext* context, PathState* s) {
  path_add(s, xyz(s->kd) * gather_radiance(context, s));
  return HR_HAS(LIGHTS) ? next_light_sample(context, s) : after_lights(context, s);
}

#endif
