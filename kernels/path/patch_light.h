// What patches send of the light that a radiosity solution says comes to them.
#ifndef HR_PATH_PATCH_LIGHT_H
#define HR_PATH_PATCH_LIGHT_H

#include "lib/surface.h"

#define HR_1_OVER_PI REAL(0.3183098861837907)

static inline real3 patch_irradiance(const SceneView* view, const Hit* hit, bool front) {
  global const float4* corner = view->patch_light + 6 * hit->primitive + (front ? 0 : 3);
  return param3(corner[0]) * (1 - hit->u - hit->v) + param3(corner[1]) * hit->u + param3(corner[2]) * hit->v;
}

// Radiance that a translucent patch passes of the irradiance on its other side: Lambert's law.
static inline real3 passed_light(const SceneView* view, const Hit* hit, const Surface* surface) {
  if (!(hit->primitive < view->triangle_count)) return (real3)(0);
  const Material m = view->materials[surface->material];
  const real3 tau = (real3)(m.translucency_r, m.translucency_g, m.translucency_b);
  return tau * patch_irradiance(view, hit, !surface->front) * HR_1_OVER_PI;
}

// And what it reflects of that on the hit's side, too.
static inline real3 diffuse_light(const SceneView* view, const Hit* hit, const Surface* surface) {
  if (!(hit->primitive < view->triangle_count)) return (real3)(0);
  const real3 reflected = surface->kd * patch_irradiance(view, hit, surface->front) * HR_1_OVER_PI;
  return reflected + passed_light(view, hit, surface);
}

#endif
