// One sample of a light: which way it lies, how far, and how much it sends before the surface's own cosine.
#ifndef HR_LIB_LIGHT_H
#define HR_LIB_LIGHT_H

#include "lib/math.h"
#include "lib/rng.h"
#include "lib/scene_view.h"
#include "lib/surface.h"

typedef struct LightSample {
  real3 direction;  // unit, to the light
  real distance;    // [m]; infinite for directional lights
  // physical: irradiance on a surface that faces the light [W/m^2]; phong: the source's L
  real3 irradiance;
  uint first_primitive, last_primitive;  // of the light itself; first > last if it has none
} LightSample;

// Do all its shadow rays end at light->position?
static inline bool shines_from_a_point(const Light* light) {
  if (HR_HAS(POINT_LIGHTS) && light->kind == HR_LIGHT_POINT) return true;
  return HR_HAS(SPOT_LIGHTS) && light->kind == HR_LIGHT_SPOT;
}

// glTF's KHR_lights_punctual fall-off between the inner and outer cone.
static inline real spot_factor(const Light* light, real3 from_light) {
  const real cosine = dot3(param3(light->direction), from_light);
  const real x = clamp((cosine - light->position.w) * light->direction.w, REAL(0.0), REAL(1.0));
  return x * x;
}

// Sets direction and distance to `point`; false if it lies on the surface point itself.
static inline bool aim_at(real3 position, real3 point, LightSample* s) {
  const real3 d = point - position;
  s->distance = square_root(dot3(d, d));
  if (!(s->distance > 0)) return false;
  s->direction = divide3(d, s->distance);
  return true;
}

// Share of what an element of area `area_m2` with normal `n` and radiance L sends: L times this.
static inline real area_factor(const LightSample* s, real3 n, real area_m2) {
  const real cosine = -dot3(s->direction, n);
  return cosine > 0 ? divide(cosine * area_m2, s->distance * s->distance) : REAL(0.0);
}

static inline bool sample_area_light(const Light* light, uint k, real4 xi, real3 position, LightSample* s) {
  const real u = divide((real)(k % light->samples_u) + xi.x, (real)light->samples_u);
  const real v = divide((real)(k / light->samples_u) + xi.y, (real)light->samples_v);
  const real3 point = param3(light->position) + param3(light->edge_u) * u + param3(light->edge_v) * v;
  if (!aim_at(position, point, s)) return false;
  const real factor = HR_HAS(PHONG_SHADING) ? divide(1, (real)light->sample_count)
                                            : area_factor(s, param3(light->direction), light->intensity.w);
  s->irradiance = param3(light->intensity) * factor;
  if (light->primitive_count > 0) {
    s->first_primitive = light->first_primitive;
    s->last_primitive = light->first_primitive + light->primitive_count - 1;
  }
  return true;
}

// Index of the emitter whose share of the cumulative weights holds u.
static inline uint find_emitter(const SceneView* view, real u) {
  uint lo = 0, hi = view->emitter_count - 1;
  while (lo < hi) {
    const uint middle = (lo + hi) / 2;
    if (u < view->emitters[middle].cumulative) {
      hi = middle;
    } else {
      lo = middle + 1;
    }
  }
  return lo;
}

// A point on the emissive meshes and spheres, chosen by area and emission; sample k of n takes the k-th part of the
// cumulative weights.
static inline bool sample_emitters(const SceneView* view, const Light* light, uint k, real4 xi, real3 position,
                                   LightSample* s) {
  const real n = (real)light->sample_count;
  const Emitter emitter = view->emitters[find_emitter(view, divide((real)k + xi.x, n))];
  real3 point, normal;
  Surface lit;
  if (HR_HAS(TRIANGLES) && emitter.primitive < view->triangle_count) {
    const TriangleGeometry g = load_triangle(view, emitter.primitive);
    const real root = square_root(xi.y);
    const real u = root * (1 - xi.z), v = root * xi.z;
    point = g.a * (1 - root) + g.b * u + g.c * v;
    normal = normal_of_edges(g.b - g.a, g.c - g.a);
    const real2 uv = HR_HAS(TEXTURES) ? interpolate_uv(view, g.indices, u, v) : (real2)(0);
    shade_material(view, g.indices.w, uv, HR_HAS(TEXTURES), (real3)(1), &lit);
  } else if (HR_HAS(SPHERES)) {
    const Sphere sphere = view->spheres[emitter.primitive - view->triangle_count];
    const real z = 1 - 2 * xi.y;
    const real radius = square_root(max(1 - z * z, REAL(0.0)));
    const real2 turn = sincos_turn(xi.z);
    normal = (real3)(radius * turn.y, radius * turn.x, z);
    point = param3(sphere.center_radius) + normal * sphere.center_radius.w;
    shade_material(view, sphere.material, (real2)(0), false, (real3)(1), &lit);
  } else {
    return false;
  }
  if (!aim_at(position, point, s)) return false;
  const real factor = divide(HR_HAS(PHONG_SHADING) ? REAL(1.0) : area_factor(s, normal, emitter.inverse_pdf), n);
  s->irradiance = lit.emission * factor;
  s->first_primitive = emitter.primitive;
  s->last_primitive = emitter.primitive;
  return true;
}

// Sample k of `light` as seen from `position`. False, or zero irradiance, if it can send nothing.
static inline bool sample_light(const SceneView* view, const Light* light, uint k, uint4 rng_key, real3 position,
                                LightSample* s) {
  s->first_primitive = 1;
  s->last_primitive = 0;
  real4 xi = (real4)(REAL(0.5));
  if (light->jitter) {
    const uint4 bits = rng_hash(rng_key);
    xi = (real4)(rng_unit(bits.x), rng_unit(bits.y), rng_unit(bits.z), rng_unit(bits.w));
  }
  if (HR_HAS(AREA_LIGHTS) && light->kind == HR_LIGHT_AREA) return sample_area_light(light, k, xi, position, s);
  if (HR_HAS(EMITTERS) && light->kind == HR_LIGHT_EMITTERS) return sample_emitters(view, light, k, xi, position, s);
  if (HR_HAS(DIRECTIONAL_LIGHTS) && light->kind == HR_LIGHT_DIRECTIONAL) {
    s->direction = -param3(light->direction);
    s->distance = INFINITY;
    s->irradiance = param3(light->intensity);
    return true;
  }
  if (!aim_at(position, param3(light->position), s)) return false;
  const real falloff = HR_HAS(PHONG_SHADING) ? REAL(1.0) : divide(1, s->distance * s->distance);
  real factor = falloff;
  if (HR_HAS(SPOT_LIGHTS) && light->kind == HR_LIGHT_SPOT) factor *= spot_factor(light, -s->direction);
  s->irradiance = param3(light->intensity) * factor;
  return true;
}

#endif
