// The residual of a solution at points of patches (Arvo, Torrance, Smits 1994, "A Framework for the Analysis of Error
// in Global Illumination Algorithms"): what the equation of light lacks there, with radiosity constant on each patch.
#include "lib/math.h"
#include "lib/offset.h"
#include "lib/rng.h"
#include "lib/surface.h"
#include "lib/traverse.h"
#include "shared/radiosity_types.h"

#define HR_DIMENSION_POINT 104u
#define HR_DIMENSION_RAY 105u

// A mean over strata^2 rays, cosine-distributed about the side's normal, one a stratum of the disk: the radiosity of
// what they meet is the point's irradiance [W/m^2].
static inline real3 irradiance_at(const SceneView* view, uint side, real3 position, real3 error,
                                  global const float4* restrict patch_normals, global const float4* restrict radiosity,
                                  uint strata, uint4 key) {
  const TriangleGeometry g = load_triangle(view, side / 2);
  const real3 normal = param3(patch_normals[side / 2]) * (side & 1u ? -REAL(1.0) : REAL(1.0));
  const real3 along = normalize3(g.b - g.a), across = cross3(normal, along);
  const real3 origin = offset_origin(position, error, normal, normal);
  const Skip skip = {side / 2, 1, 0};
  real3 sum = (real3)(0);
  const real width = divide(1, (real)strata);
  for (uint i = 0; i < strata * strata; i++) {
    const uint4 random = rng_hash((uint4)(key.x, key.y, i, key.w));
    const real u = ((real)(i % strata) + rng_unit(random.x)) * width, radius = square_root(u);
    const real2 turn = sincos_turn(((real)(i / strata) + rng_unit(random.y)) * width) * radius;
    const real3 direction = along * turn.y + across * turn.x + normal * square_root(1 - u);
    const Ray ray = make_ray(origin, direction, 0, INFINITY);
    const uint met = traverse_closest(view, &ray, &skip).primitive;
    if (met == HR_NO_PRIMITIVE) continue;
    sum += param3(radiosity[2 * met + (dot3(direction, param3(patch_normals[met])) < 0 ? 0u : 1u)]);
  }
  return sum * width * width;
}

// products[i] = r r', rgb, w = 0 [W^2/m^4], of two estimates of the residual E + rho H + tau H' - B at one random point
// of sides[i], each from strata^2 rays of its own a side: their product's mean is the square of the residual, without
// the rays' noise. Launch: count items.
kernel void radiosity_probe_residual(HR_SCENE_PARAMETERS global const float4* restrict patch_normals,
                                     global const uint* restrict sides, global const float4* restrict emission,
                                     global const float4* restrict reflectance,
                                     global const float4* restrict transmittance,
                                     global const float4* restrict radiosity, const uint count, const uint strata,
                                     const uint seed_key, global float4* restrict products, const RenderParams params) {
  const uint i = (uint)get_global_id(0);
  if (i >= count) return;
  HR_MAKE_SCENE_VIEW(params)
  const uint side = sides[i];
  const TriangleGeometry g = load_triangle(&view, side / 2);
  const uint4 random = rng_hash((uint4)(side, i, 0, HR_DIMENSION_POINT ^ seed_key));
  // Uniform on the triangle.
  const real root = square_root(rng_unit(random.x)), v = rng_unit(random.y) * root;
  const real3 wa = g.a * (1 - root), wb = g.b * (root - v), wc = g.c * v;
  const real3 position = wa + wb + wc, error = (fabs(wa) + fabs(wb) + fabs(wc)) * HR_GAMMA(7);
  const float4 tau = transmittance[side];
  const bool passes = max(tau.x, max(tau.y, tau.z)) > 0;
  real3 product = (real3)(1);
  for (uint half_of = 0; half_of < 2; half_of++) {
    const uint4 key = (uint4)(i, 2 * half_of, 0, HR_DIMENSION_RAY ^ seed_key);
    real3 r = param3(emission[side]) - param3(radiosity[side]);
    r += param3(reflectance[side]) * irradiance_at(&view, side, position, error, patch_normals, radiosity, strata, key);
    if (passes) {
      const uint4 other = key + (uint4)(0, 1, 0, 0);
      r += param3(tau) * irradiance_at(&view, side ^ 1u, position, error, patch_normals, radiosity, strata, other);
    }
    product *= r;
  }
  products[i] = (float4)((float)product.x, (float)product.y, (float)product.z, 0);
}
