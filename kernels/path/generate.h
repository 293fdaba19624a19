// Stage: the camera ray of a pixel sample.
#ifndef HR_PATH_GENERATE_H
#define HR_PATH_GENERATE_H

#include "lib/camera.h"
#include "lib/rng.h"
#include "path/path_context.h"

static inline uint stage_generate(const PathContext* context, PathState* s) {
  const uint pixel = path_pixel(context);
  const uint width = context->params.width;
  const real2 offset =
      rng_pixel_offset(pixel, context->params.sample, context->params.samples, context->params.seed_key);
  real3 origin, direction;
  camera_ray(&context->params, pixel % width, pixel / width, offset, &origin, &direction);
  s->ray_origin = vec4(origin, 0);
  s->ray_direction = vec4(direction, 0);
  s->ray_skip = HR_NO_PRIMITIVE;
  s->control = (uint4)(0, 0, 1, HR_KIND_DIRECT);
  s->weight = (real4)(1);
  s->sum_direct = (float4)(0);
  s->sum_reflection = (float4)(0);
  s->sum_refraction = (float4)(0);
  return HR_STAGE_intersect_closest;
}

#endif
