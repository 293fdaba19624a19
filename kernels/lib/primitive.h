// A primitive of the scene as leaf record and box; what is not finite or has no area does not go into the tree.
#ifndef HR_LIB_PRIMITIVE_H
#define HR_LIB_PRIMITIVE_H

#include "lib/vec.h"
#include "shared/bvh_types.h"
#include "shared/features.h"
#include "shared/scene_types.h"

#define HR_PRIMITIVE_VALID 0u
#define HR_PRIMITIVE_NON_FINITE 1u
#define HR_PRIMITIVE_DEGENERATE 2u

typedef struct Box {
  float4 lo;
  float4 hi;
} Box;

static inline bool is_finite4(float4 v) { return isfinite(v.x) && isfinite(v.y) && isfinite(v.z); }

static inline float4 vertex_at(global const float* positions, uint i) {
  return (float4)(positions[3 * i], positions[3 * i + 1], positions[3 * i + 2], 0.0f);
}

static inline BvhLeaf load_primitive(global const float* positions, global const uint4* triangles,
                                     global const Sphere* spheres, uint triangle_count, uint primitive) {
  BvhLeaf leaf;
  if (primitive < triangle_count) {
    const uint4 i = triangles[primitive];
    leaf.a = vertex_at(positions, i.x);
    leaf.b = vertex_at(positions, i.y);
    leaf.c = vertex_at(positions, i.z);
  } else {
    const float4 s = spheres[primitive - triangle_count].center_radius;
    leaf.a = (float4)(s.x, s.y, s.z, 0.0f);
    leaf.b = (float4)(s.w, 0.0f, 0.0f, 0.0f);
    leaf.c = (float4)(0.0f);
  }
  leaf.a.w = as_float(primitive);
  return leaf;
}

// The box of a sphere is rounded outwards by an ulp of its largest coordinate.
static inline Box primitive_box(BvhLeaf leaf, bool is_triangle) {
  Box box;
  if (is_triangle) {
    box.lo = min(min(leaf.a, leaf.b), leaf.c);
    box.hi = max(max(leaf.a, leaf.b), leaf.c);
  } else {
    const float4 pad = (fabs(leaf.a) + leaf.b.x) * (2.0f * (float)HR_HALF_ULP);
    box.lo = leaf.a - leaf.b.x - pad;
    box.hi = leaf.a + leaf.b.x + pad;
  }
  box.lo.w = 0.0f;
  box.hi.w = 0.0f;
  return box;
}

static inline uint primitive_status(BvhLeaf leaf, bool is_triangle) {
#pragma OPENCL FP_CONTRACT OFF
  const Box box = primitive_box(leaf, is_triangle);
  if (!is_finite4(leaf.a) || !is_finite4(leaf.b) || !is_finite4(leaf.c) || !is_finite4(box.lo + box.hi)) {
    return HR_PRIMITIVE_NON_FINITE;
  }
  if (!is_triangle) return leaf.b.x > 0 ? HR_PRIMITIVE_VALID : HR_PRIMITIVE_DEGENERATE;
  const real3 a = (real3)(leaf.a.x, leaf.a.y, leaf.a.z);
  const real3 e1 = (real3)(leaf.b.x, leaf.b.y, leaf.b.z) - a;
  const real3 e2 = (real3)(leaf.c.x, leaf.c.y, leaf.c.z) - a;
  const real3 largest = max(fabs(e1), fabs(e2));
  // Scaled by a power of two, so without rounding: the area of a tiny triangle must not underflow, that of a line must
  // be zero.
  const real scale = as_float(as_uint(max_component(largest)) & 0x7f800000u);
  if (!(scale > 0)) return HR_PRIMITIVE_DEGENERATE;
  const real3 f1 = e1 / scale, f2 = e2 / scale;
  const real3 left = (real3)(f1.y * f2.z, f1.z * f2.x, f1.x * f2.y);
  const real3 right = (real3)(f1.z * f2.y, f1.x * f2.z, f1.y * f2.x);
  return left.x != right.x || left.y != right.y || left.z != right.z ? HR_PRIMITIVE_VALID : HR_PRIMITIVE_DEGENERATE;
}

#endif
