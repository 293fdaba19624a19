// Stage: reflection and refraction. Where a surface does both, the refracted ray waits on the path's stack until the
// reflected one is done: depth first, so sums have one order.
#ifndef HR_PATH_SCATTER_H
#define HR_PATH_SCATTER_H

#include "lib/bsdf.h"
#include "lib/offset.h"
#include "path/path_context.h"

// Primitive that a scattered ray may not meet again: the flat one it leaves. A ray inside a sphere or on a curved shape
// meets it again.
static inline uint left_primitive(const PathContext* context, const PathState* s) {
  const uint primitive = s->surface.z;
  const bool is_sphere = primitive >= context->view.triangle_count &&
                         primitive < context->view.triangle_count + context->view.sphere_count;
  const bool again = (HR_HAS(SPHERES) && is_sphere) || is_curved_shape(&context->view, primitive);
  return again ? HR_NO_PRIMITIVE : primitive;
}

static inline uint first_bounce_kind(const PathState* s, uint kind) {
  return s->control.x == 0 ? kind : s->control.w & 255u;
}

static inline void push_branch(const PathContext* context, PathState* s, real3 origin, real3 direction, real3 weight) {
  const uint size = s->control.w >> 8;
  PendingBranch branch;
  branch.origin = vec4(origin, 0);
  branch.direction = vec4(direction, 0);
  branch.weight = vec4(weight, 0);
  branch.control = (uint4)(s->control.x + 1, left_primitive(context, s), first_bounce_kind(s, HR_KIND_REFRACTION), 0);
  context->branches[size * context->params.slot_count + context->slot] = branch;
  s->control.w += 1u << 8;
}

static inline uint follow(const PathContext* context, PathState* s, real3 direction, real3 weight, uint kind) {
  const real3 origin = offset_origin(xyz(s->position), xyz(s->position_error), xyz(s->normal), direction);
  s->ray_skip = left_primitive(context, s);
  s->ray_origin = vec4(origin, 0);
  s->ray_direction = vec4(direction, 0);
  s->weight = vec4(weight, 0);
  s->control =
      (uint4)(s->control.x + 1, s->control.z, s->control.z + 1, first_bounce_kind(s, kind) | (s->control.w & ~255u));
  return HR_STAGE_intersect_closest;
}

// kr Ir + kt It; with Fresnel's equations kr R Ir + kt (1 - R) It.
static inline uint stage_scatter(const PathContext* context, PathState* s) {
  const Material m = context->view.materials[s->surface.x];
  const real3 d = xyz(s->ray_direction), n = xyz(s->shading_normal), n_geometric = xyz(s->normal);
  real3 kr = param3(m.kr), kt = (real3)(0), refracted = (real3)(0);
  if (HR_HAS(REFRACTION)) {
    kt = param3(m.kt);
    const real eta = s->surface.y ? divide(1, m.ks.w) : m.ks.w;
    const bool transmits = max_component(kt) > 0;
    if (HR_HAS(FRESNEL) && transmits && (m.flags & HR_MATERIAL_FRESNEL)) {
      const real cosine = max(dot3(d, n) < 0 ? -dot3(d, n) : -dot3(d, n_geometric), REAL(0.0));
      const real r = fresnel_dielectric(cosine, eta);
      kr *= r;
      kt *= 1 - r;
    }
    if (!transmits || !refract_direction(d, n, n_geometric, eta, &refracted)) kt = (real3)(0);
  }
  const real3 weight = xyz(s->weight);
  const bool reflects = HR_HAS(REFLECTION) && max_component(kr) > 0;
  const bool refracts = HR_HAS(REFRACTION) && max_component(kt) > 0;
  if (reflects) {
    if (HR_HAS(BRANCHING) && refracts) {
      const real3 origin = offset_origin(xyz(s->position), xyz(s->position_error), n_geometric, refracted);
      push_branch(context, s, origin, refracted, weight * kt);
    }
    return follow(context, s, reflect_direction(d, n, n_geometric), weight * kr, HR_KIND_REFLECTION);
  }
  if (refracts) return follow(context, s, refracted, weight * kt, HR_KIND_REFRACTION);
  return path_end_of_branch(s);
}

#endif
