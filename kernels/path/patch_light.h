// What patches send of the light that a radiosity solution says comes to them.
#ifndef HR_PATH_PATCH_LIGHT_H
#define HR_PATH_PATCH_LIGHT_H

#include "lib/surface.h"

// Radiance that a patch reflects of the irradiance on the hit's side of it: Lambert's law.
static inline real3 diffuse_light(const SceneView* view, const Hit* hit, const Surface* surface) {
  if (!(hit->primitive < view->triangle_count)) return (real3)(0);
  global const float4* corner = view->patch_light + 6 * hit->primitive + (surface->front ? 0 : 3);
  const real3 irradiance =
      param3(corner[0]) * (1 - hit->u - hit->v) + param3(corner[1]) * hit->u + param3(corner[2]) * hit->v;
  return surface->kd * irradiance * REAL(0.3183098861837907);
}

#endif
