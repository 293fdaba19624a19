// What a surface does with light: the diffuse and glossy answer to one light sample, mirror reflection, refraction,
// Fresnel's equations.
#ifndef HR_LIB_BSDF_H
#define HR_LIB_BSDF_H

#include "lib/math.h"
#include "lib/vec.h"
#include "shared/features.h"

#define HR_INV_PI REAL(0.31830988618379067)
#define HR_INV_8PI REAL(0.039788735772973836)

// Physical shading: BRDF times cosine, kd/pi + ks (n+8)/(8 pi) (n.h)^n (normalised Blinn-Phong; Akenine-Moeller et al.,
// Real-Time Rendering, 3rd ed., 7.6). Phong shading: the source's kd max(n.l,0) + ks max(n.h,0)^n; the cosine is
// clamped before the power (the source clamps after it, which lights the back for even exponents).
static inline real3 bsdf_reflect_light(real3 kd, real3 ks, real shininess, real3 n, real3 to_light, real3 to_viewer) {
  const real cosine = max(dot3(n, to_light), REAL(0.0));
  real lobe = 0;
  if (HR_HAS(SPECULAR)) {
    const real3 half_sum = to_light + to_viewer;
    const real length2 = dot3(half_sum, half_sum);
    const real cosine_half = length2 > 0 ? max(divide(dot3(n, half_sum), square_root(length2)), REAL(0.0)) : REAL(0.0);
    lobe = cosine_power(min(cosine_half, REAL(1.0)), shininess);
  }
  if (HR_HAS(PHONG_SHADING)) {
    return HR_HAS(SPECULAR) ? kd * cosine + ks * lobe : kd * cosine;
  }
  real3 f = kd * HR_INV_PI;
  if (HR_HAS(SPECULAR)) f += ks * ((shininess + 8) * HR_INV_8PI * lobe);
  return f * cosine;
}

// Mirror direction about n, about the geometric normal where n would send it below the surface.
static inline real3 reflect_direction(real3 d, real3 n, real3 geometric_normal) {
  const real3 r = d - n * (2 * dot3(d, n));
  if (dot3(r, geometric_normal) > 0) return normalize3(r);
  return normalize3(d - geometric_normal * (2 * dot3(d, geometric_normal)));
}

// Snell's law; eta = index on the ray's side / index beyond. False under total internal reflection.
static inline bool refract_about(real3 d, real3 n, real eta, real3* t) {
  const real cosine_i = -dot3(d, n);
  const real sine2_t = eta * eta * max(1 - cosine_i * cosine_i, REAL(0.0));
  if (sine2_t >= 1) return false;
  *t = normalize3(d * eta + n * (eta * cosine_i - square_root(1 - sine2_t)));
  return true;
}

static inline bool refract_direction(real3 d, real3 n, real3 geometric_normal, real eta, real3* t) {
  if (!refract_about(d, dot3(d, n) < 0 ? n : geometric_normal, eta, t)) return false;
  return dot3(*t, geometric_normal) < 0 || refract_about(d, geometric_normal, eta, t);
}

// Unpolarised reflectance of a smooth dielectric; 1 under total internal reflection.
static inline real fresnel_dielectric(real cosine_i, real eta) {
  const real sine2_t = eta * eta * max(1 - cosine_i * cosine_i, REAL(0.0));
  if (sine2_t >= 1) return 1;
  const real cosine_t = square_root(1 - sine2_t);
  const real parallel = divide(cosine_i - eta * cosine_t, cosine_i + eta * cosine_t);
  const real perpendicular = divide(eta * cosine_i - cosine_t, eta * cosine_i + cosine_t);
  return REAL(0.5) * (parallel * parallel + perpendicular * perpendicular);
}

#endif
