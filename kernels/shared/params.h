// What one launch of a path kernel needs beside the scene's buffers; passed by value.
#ifndef HR_SHARED_PARAMS_H
#define HR_SHARED_PARAMS_H

#include "shared/scalar.h"

HR_SHARED_BEGIN

typedef struct RenderParams {
  float4 camera_position;  // world [m]
  float4 camera_right;     // unit; w = half width of the image at distance 1 (perspective) or in metres (orthographic)
  float4 camera_up;        // unit; w = half height, likewise
  float4 camera_back;      // unit; the camera looks along its negative
  float4 background;       // rgb radiance of a miss [W/m^2/sr]
  float4 ambient;          // rgb La [W/m^2/sr]
  uint width;              // [pixels]
  uint height;
  uint first_pixel;  // pixel of slot 0
  uint slot_count;   // slots of the wave, the stride of the branch stack
  uint sample;       // index of this sample in [0, samples)
  uint samples;      // per pixel
  uint seed_key;     // seed * 0x9E3779B9
  uint max_depth;    // bounces
  uint triangle_count;
  uint sphere_count;
  uint plane_count;
  uint light_count;
  uint emitter_count;
  uint instance_count;
  uint shape_count;
  uint gather_rays;  // of a final gather, a hit
} RenderParams;

HR_SHARED_END

#endif
