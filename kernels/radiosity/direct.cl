// What arrives from lights that are no surfaces: point, spot and directional lights, and area lights that are not seen.
#include "lib/light.h"
#include "lib/offset.h"
#include "lib/traverse.h"

#define HR_DIRECT_POINTS 4u
#define HR_DIMENSION_DIRECT 103u
// As HR_SHADOW_RAY_MARGIN of path/light_loop.h.
#define HR_DIRECT_MARGIN (16 * HR_HALF_ULP)

// direct[4 side + point] = irradiance [W/m^2], rgb, w = 0, at the middle of one of the triangle's four congruent parts.
// Launch: 4 count items, count the sides.
kernel void radiosity_add_direct(HR_SCENE_PARAMETERS global const float4* restrict patch_normals,
                                 global float4* restrict direct, const uint count, const RenderParams params) {
  const uint side = (uint)get_global_id(0) / HR_DIRECT_POINTS, point = (uint)get_global_id(0) % HR_DIRECT_POINTS;
  if (side >= count) return;
  HR_MAKE_SCENE_VIEW(params)
  const TriangleGeometry g = load_triangle(&view, side / 2);
  const real3 normal = param3(patch_normals[side / 2]) * (side & 1u ? -REAL(1.0) : REAL(1.0));
  // Of the vertices: the corner parts at b, at c and at a, then the middle one.
  const real u = (point == 0 ? REAL(4.0) : (point == 3 ? REAL(2.0) : REAL(1.0))) / 6;
  const real v = (point == 1 ? REAL(4.0) : (point == 3 ? REAL(2.0) : REAL(1.0))) / 6;
  const real3 wa = g.a * (1 - u - v), wb = g.b * u, wc = g.c * v;
  const real3 position = wa + wb + wc, error = (fabs(wa) + fabs(wb) + fabs(wc)) * HR_GAMMA(7);
  const real3 origin = offset_origin(position, error, normal, normal);
  const Skip skip = {side / 2, 1, 0};
  real3 sum = (real3)(0);
  for (uint l = 0; l < view.light_count; l++) {
    const Light light = view.lights[l];
    for (uint k = 0; k < light.sample_count; k++) {
      LightSample sample;
      const uint4 key = (uint4)(side, point, l, (HR_DIMENSION_DIRECT + k) ^ params.seed_key);
      if (!sample_light(&view, &light, k, key, position, &sample)) continue;
      const real cosine = dot3(normal, sample.direction);
      if (!(cosine > 0)) continue;
      const Ray ray = make_ray(origin, sample.direction, 0, sample.distance * (1 - HR_DIRECT_MARGIN));
      if (!traverse_any(&view, &ray, &skip)) sum += sample.irradiance * cosine;
    }
  }
  direct[HR_DIRECT_POINTS * side + point] = (float4)((float)sum.x, (float)sum.y, (float)sum.z, 0);
}
