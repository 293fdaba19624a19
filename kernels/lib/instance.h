// Copies of a mesh that share its tree: between the world and the space of their object, p_world = L p + T. The way
// back is taken as L^-1 (p_world - T): the error then grows with the distance from the copy, not from the origin.
#ifndef HR_LIB_INSTANCE_H
#define HR_LIB_INSTANCE_H

#include "lib/intersect.h"
#include "lib/scene_view.h"

// A leaf of the tree of instances has no blocks and names its one instance: ~((instance + 1) << 4).
static inline bool is_instance_leaf(int child) { return child < 0 && ((uint)~child & 15u) == 0; }

static inline uint leaf_instance(int child) { return ((uint)~child >> 4) - 1; }

static inline real3 instance_place(global const Instance* i) {
  return (real3)(i->to_world_x.w, i->to_world_y.w, i->to_world_z.w);
}

// L v.
static inline real3 vector_to_world(global const Instance* i, real3 v) {
  return (real3)(dot3(param3(i->to_world_x), v), dot3(param3(i->to_world_y), v), dot3(param3(i->to_world_z), v));
}

// L^-1 v.
static inline real3 vector_to_object(global const Instance* i, real3 v) {
  return (real3)(dot3(param3(i->to_object_x), v), dot3(param3(i->to_object_y), v), dot3(param3(i->to_object_z), v));
}

// |L| v and |L^-1| v: bounds of what an error v >= 0 becomes.
static inline real3 error_to_world(global const Instance* i, real3 v) {
  return (real3)(dot3(fabs(param3(i->to_world_x)), v), dot3(fabs(param3(i->to_world_y)), v),
                 dot3(fabs(param3(i->to_world_z)), v));
}

static inline real3 error_to_object(global const Instance* i, real3 v) {
  return (real3)(dot3(fabs(param3(i->to_object_x)), v), dot3(fabs(param3(i->to_object_y)), v),
                 dot3(fabs(param3(i->to_object_z)), v));
}

// Unit normal from object space: the transpose of L^-1, which keeps the side also where L mirrors.
static inline real3 normal_to_world(global const Instance* i, real3 n) {
  return normalize3(param3(i->to_object_x) * n.x + param3(i->to_object_y) * n.y + param3(i->to_object_z) * n.z);
}

// The ray as the object sees it. Its direction is not made unit again, so t means the same on both sides.
static inline Ray ray_to_object(global const Instance* i, const Ray* ray) {
  return make_ray(vector_to_object(i, ray->origin - instance_place(i)), vector_to_object(i, ray->direction), ray->t_min,
                  ray->t_max);
}

// A point of the object with its error bound goes to the world. Added to |L| error are the rounding of the entries of
// L, three products, two sums and T; and what L^-1 (p_world - T) makes of the point when a ray that starts there comes
// back to this object (difference, entries of L and L^-1, three products and two sums), seen from the world: |L| |L^-1|
// |L p|. Pharr, Jakob, Humphreys, Physically Based Rendering, 4th ed., 6.8.5.
static inline void point_to_world(global const Instance* i, real3* p, real3* error) {
  const real3 reach = error_to_world(i, fabs(*p));
  const real3 again = error_to_world(i, error_to_object(i, reach));
  *error = error_to_world(i, *error) + (reach + fabs(instance_place(i))) * HR_GAMMA(6) + again * HR_GAMMA(8);
  *p = vector_to_world(i, *p) + instance_place(i);
}

// The first index that belongs to an instance.
static inline uint first_instanced(const SceneView* view) { return first_plane(view) + view->plane_count; }

// The instance that primitive >= first_instanced() belongs to.
static inline global const Instance* instance_of(const SceneView* view, uint primitive) {
  uint lo = 0, hi = view->instance_count;  // first_id of lo is not beyond it, that of hi is
  while (hi - lo > 1) {
    const uint middle = lo + (hi - lo) / 2;
    if (view->instances[middle].first_id <= primitive) {
      lo = middle;
    } else {
      hi = middle;
    }
  }
  return view->instances + lo;
}

#endif
