// A ray against one primitive of a leaf's block, and what the numbers in blocks mean.
#ifndef HR_LIB_LEAF_LANE_H
#define HR_LIB_LEAF_LANE_H

#include "lib/accel_layout.h"
#include "lib/intersect.h"
#include "lib/lanes.h"
#include "lib/scene_view.h"
#include "lib/shape.h"

#if HR_HAS(IMPLICITS)  // much text, which costs compilers time
#include "lib/implicit.h"
#endif

// Blocks may hold what is not a triangle, and is tested lane by lane.
#define HR_HAS_ONE_BY_ONE (HR_HAS(SPHERES) || HR_HAS(SHAPES))

// Primitives a ray must not meet: the one it left, and those of the light it is traced to (inclusive range, which is
// empty if skip_first > skip_last).
typedef struct Skip {
  uint self;
  uint first, last;
} Skip;

// What the numbers in a tree's blocks mean.
typedef struct BlockNumbers {
  uint first;      // added to one, makes it a primitive index
  uint triangles;  // those below are triangles
  uint shapes;     // those from here on are shapes, what is between them spheres
  global const Shape* shape_array;
  global const uint4* tapes;
  global uint* uncertain_roots;
} BlockNumbers;

static inline BlockNumbers world_numbers(const SceneView* view) {
  const BlockNumbers numbers = {0,           view->triangle_count, first_shape(view), view->shapes,
                                view->tapes, view->uncertain_roots};
  return numbers;
}

static inline bool is_skipped(const Skip* skip, uint primitive) {
  return primitive == skip->self || (primitive >= skip->first && primitive <= skip->last);
}

static inline bool is_closer(const Hit* candidate, const Hit* best) {
  return candidate->t < best->t || (candidate->t == best->t && candidate->primitive < best->primitive);
}

static inline uint block_primitive(global const float* block, uint lane) {
  return ((global const uint*)block)[HR_BLOCK_PRIMITIVE_ROW * HR_L + lane];
}

static inline real3 block_point(global const float* block, uint row, uint lane) {
  return (real3)(block[row * HR_L + lane], block[(row + 1) * HR_L + lane], block[(row + 2) * HR_L + lane]);
}

// One lane by itself: spheres, shapes, and triangles on devices without explicit vectors. What lies beyond t_far need
// not be found.
static inline bool intersect_lane(BlockNumbers numbers, global const float* block, uint lane, const Ray* ray,
                                  real t_far, Hit* candidate) {
  const uint number = block_primitive(block, lane);
  if (number == HR_NO_PRIMITIVE) return false;
  candidate->primitive = numbers.first + number;
  candidate->u = 0;
  candidate->v = 0;
  if (HR_HAS(SHAPES) && number >= numbers.shapes && number >= numbers.triangles) {
    global const Shape* shape = numbers.shape_array + (number - numbers.shapes);
#if HR_HAS(IMPLICITS)
    if (shape->kind == HR_SHAPE_IMPLICIT) {
      uint uncertain = 0;
      const bool hit = intersect_implicit(numbers.tapes, shape, ray, t_far, &candidate->t, &uncertain);
      if (HR_UNLIKELY(uncertain != 0)) atomic_add(numbers.uncertain_roots, uncertain);
      return hit;
    }
#endif
    return intersect_shape(ray, shape, &candidate->t, &candidate->u);
  }
  const real3 a = block_point(block, 0, lane);
  if (HR_HAS(SPHERES) && number >= numbers.triangles) {
    return intersect_sphere(ray, a, block[3 * HR_L + lane], &candidate->t);
  }
  const real3 b = block_point(block, 3, lane), c = block_point(block, 6, lane);
  if (HR_TRIANGLE_WATERTIGHT) return intersect_triangle(ray, a, b, c, &candidate->t, &candidate->u, &candidate->v);
  return intersect_triangle_fast(ray, a, b, c, &candidate->t, &candidate->u, &candidate->v);
}

#endif
