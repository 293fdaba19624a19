// Stage: surface data at the hit, emission and ambient light, then the first light sample.
#ifndef HR_PATH_SHADE_SURFACE_H
#define HR_PATH_SHADE_SURFACE_H

#include "lib/surface.h"
#include "path/light_loop.h"
#include "path/patch_light.h"

// The first sample's camera ray writes the geometric layers of the film.
static inline void write_aovs(const PathContext* context, const PathState* s, const Surface* surface) {
  if (context->params.sample != 0 || s->control.x != 0) return;
  const uint pixel = path_pixel(context);
  context->aov_normal_depth[pixel] = (float4)((float)surface->shading_normal.x, (float)surface->shading_normal.y,
                                              (float)surface->shading_normal.z, (float)s->hit.x);
  context->aov_albedo_object[pixel] =
      (float4)((float)surface->kd.x, (float)surface->kd.y, (float)surface->kd.z, (float)(surface->object + 1));
}

static inline uint stage_shade_surface(const PathContext* context, PathState* s) {
  Hit hit;
  hit.t = s->hit.x;
  hit.u = s->hit.y;
  hit.v = s->hit.z;
  hit.primitive = s->hit_primitive;
  const Surface surface = surface_at(&context->view, xyz(s->ray_origin), xyz(s->ray_direction), &hit);
  write_aovs(context, s, &surface);
  if (s->control.x == 0) s->sum_direct.w = 1;  // coverage
  if (HR_HAS(EMISSION) && surface.front) path_add(s, surface.emission);
  if (HR_HAS(RADIOSITY)) {
    path_add(s, HR_HAS(GATHER) ? passed_light(&context->view, &hit, &surface)
                               : diffuse_light(&context->view, &hit, &surface));
  }
  if (HR_HAS(AMBIENT)) path_add(s, surface.ka * param3(context->params.ambient));
  s->position = vec4(surface.position, 0);
  s->position_error = vec4(surface.error, 0);
  s->normal = vec4(surface.normal, 0);
  s->shading_normal = vec4(surface.shading_normal, 0);
  s->lift = vec4(surface.lift, 0);
  s->kd = vec4(surface.kd, surface.shininess);
  s->ks = vec4(surface.ks, 0);
  s->surface = (uint4)(surface.material, surface.front, hit.primitive, 0);
  s->shadow_origin = s->shadow_direction = s->shadow_radiance = (real4)(0);
  s->shadow_cursor = (uint4)(0);
  if (HR_HAS(GATHER) && max_component(surface.kd) > 0) return HR_STAGE_gather;
  return HR_HAS(LIGHTS) ? next_light_sample(context, s) : after_lights(context, s);
}

#endif
