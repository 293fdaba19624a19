// Stage: surface data at the hit, emission and ambient light, then the first light sample.
#ifndef HR_PATH_SHADE_SURFACE_H
#define HR_PATH_SHADE_SURFACE_H

#include "lib/surface.h"
#include "path/light_loop.h"

// The first sample's camera ray writes the geometric layers of the film.
static inline void write_aovs(const PathContext* context, const PathState* s, const Surface* surface) {
  if (context->params.sample != 0 || s->control.x != 0) return;
  const uint pixel = path_pixel(context);
  context->aov_normal_depth[pixel] = (float4)((float)surface->shading_normal.x, (float)surface->shading_normal.y,
                                              (float)surface->shading_normal.z, (float)s->hit.x);
  context->aov_albedo_object[pixel] =
      (float4)((float)surface->kd.x, (float)surface->kd.y, (float)surface->kd.z, (float)(surface->object + 1));
}

// What a radiosity solution says comes to one side of a patch.
static inline real3 patch_irradiance(const SceneView* view, const Hit* hit, bool front) {
  global const float4* corner = view->patch_light + 6 * hit->primitive + (front ? 0 : 3);
  return param3(corner[0]) * (1 - hit->u - hit->v) + param3(corner[1]) * hit->u + param3(corner[2]) * hit->v;
}

// What a patch reflects of the light on the hit's side of it, and passes of that on the other: Lambert's law.
static inline real3 diffuse_light(const SceneView* view, const Hit* hit, const Surface* surface) {
  if (!(hit->primitive < view->triangle_count)) return (real3)(0);
  const Material m = view->materials[surface->material];
  const real3 tau = (real3)(m.translucency_r, m.translucency_g, m.translucency_b);
  const real3 sent = surface->kd * patch_irradiance(view, hit, surface->front) +
                     tau * patch_irradiance(view, hit, !surface->front);
  return sent * REAL(0.3183098861837907);
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
  if (HR_HAS(RADIOSITY)) path_add(s, diffuse_light(&context->view, &hit, &surface));
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
  return HR_HAS(LIGHTS) ? next_light_sample(context, s) : after_lights(context, s);
}

#endif
