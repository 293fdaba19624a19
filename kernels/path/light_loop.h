// The loop over light samples at a shading point, one step at a time: each step ends at a shadow ray to trace or at the
// end of the lights.
#ifndef HR_PATH_LIGHT_LOOP_H
#define HR_PATH_LIGHT_LOOP_H

#include "lib/bsdf.h"
#include "lib/light.h"
#include "lib/offset.h"
#include "path/path_context.h"

// A shadow ray ends this much (relative) before the light sample: t carries a few rounding errors.
#define HR_SHADOW_RAY_MARGIN (16 * HR_HALF_ULP)

// The primitive that shadow rays do not meet: the one that they leave, if it is flat or a sphere seen from outside.
// surface: y 1 if the front was hit, z primitive.
static inline uint shadow_skip(const SceneView* view, uint4 surface) {
  const bool is_sphere = HR_HAS(SPHERES) && surface.z - view->triangle_count < view->sphere_count;
  return is_curved_shape(view, surface.z) || (is_sphere && surface.y == 0) ? HR_NO_PRIMITIVE : surface.z;
}

static inline uint after_lights(const PathContext* context, const PathState* s) {
  if (HR_HAS(SECONDARY) && s->control.x < context->params.max_depth) {
    const Material m = context->view.materials[s->surface.x];
    const real3 sum = param3(m.kr) + param3(m.kt);
    if (max_component(sum) > 0) return HR_STAGE_scatter;
  }
  return path_end_of_branch(s);
}

// Advances shadow_cursor to the next sample that can reach the surface and prepares its shadow ray.
static inline uint next_light_sample(const PathContext* context, PathState* s) {
  const real3 n = xyz(s->normal), n_shading = xyz(s->shading_normal);
  const real3 lift = HR_HAS(SMOOTH_NORMALS) ? xyz(s->lift) : (real3)(0);
  const bool lifted = HR_HAS(SMOOTH_NORMALS) && dot3(lift, lift) > 0;
  const real3 position = lifted ? xyz(s->position) + lift : xyz(s->position);
  while (s->shadow_cursor.x < context->view.light_count) {
    const Light light = context->view.lights[s->shadow_cursor.x];
    const uint k = s->shadow_cursor.y, index = s->shadow_cursor.x;
    s->shadow_cursor.y++;
    if (s->shadow_cursor.y == light.sample_count) {
      s->shadow_cursor.x++;
      s->shadow_cursor.y = 0;
    }
    const uint4 key = (uint4)(path_pixel(context), context->params.sample, s->control.y,
                              (HR_DIMENSION_FIRST_LIGHT + light.first_sample + k) ^ context->params.seed_key);
    LightSample sample;
    if (!sample_light(&context->view, &light, k, key, position, &sample)) continue;
    if (!(dot3(lifted ? n_shading : n, sample.direction) > 0)) continue;  // the surface itself is in the way
    const real3 radiance = sample.irradiance * bsdf_reflect_light(xyz(s->kd), xyz(s->ks), s->kd.w, n_shading,
                                                                  sample.direction, -xyz(s->ray_direction));
    if (!(max_component(radiance) > 0)) continue;
    const real3 error = lifted ? xyz(s->position_error) + fabs(lift) * HR_GAMMA(16) : xyz(s->position_error);
    const real3 origin = offset_origin(position, error, n, n);
    s->shadow_origin = vec4(origin, sample.distance * (1 - HR_SHADOW_RAY_MARGIN));
    s->shadow_direction = vec4(sample.direction, shines_from_a_point(&light) ? (real)(index + 1) : (real)0);
    s->shadow_radiance = vec4(radiance, 0);
    s->shadow_cursor.z = sample.first_primitive;
    s->shadow_cursor.w = sample.last_primitive;
    return HR_STAGE_intersect_shadow;
  }
  return after_lights(context, s);
}

#endif
