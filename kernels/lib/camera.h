// Camera rays. Row 0 is the top of the image.
#ifndef HR_LIB_CAMERA_H
#define HR_LIB_CAMERA_H

#include "lib/vec.h"
#include "shared/features.h"
#include "shared/params.h"

// Ray through `offset` in [0,1)^2 of pixel (x, y); the direction has unit length.
static inline void camera_ray(const RenderParams* params, uint x, uint y, real2 offset, real3* origin,
                              real3* direction) {
  const real px = 2 * divide((real)x + offset.x, (real)params->width) - 1;
  const real py = 1 - 2 * divide((real)y + offset.y, (real)params->height);
  const real3 across = param3(params->camera_right) * (px * params->camera_right.w) +
                       param3(params->camera_up) * (py * params->camera_up.w);
  if (HR_HAS(ORTHOGRAPHIC)) {
    *origin = param3(params->camera_position) + across;
    *direction = -param3(params->camera_back);
  } else {
    *origin = param3(params->camera_position);
    *direction = normalize3(across - param3(params->camera_back));
  }
}

#endif
