// A primitive of the scene as record and box; what is not finite or has no area does not go into the tree.
#ifndef HR_LIB_PRIMITIVE_H
#define HR_LIB_PRIMITIVE_H

#include "lib/vec.h"
#include "shared/bvh_types.h"
#include "shared/features.h"
#include "shared/scene_types.h"

#define HR_PRIMITIVE_VALID 0u
#define HR_PRIMITIVE_NON_FINITE 1u
#define HR_PRIMITIVE_DEGENERATE 2u

#define HR_PRIMITIVE_TRIANGLE 0u
#define HR_PRIMITIVE_SPHERE 1u
#define HR_PRIMITIVE_SHAPE 2u

// Triangle: vertices a, b, c. Sphere: a = centre, b.x = radius. Shape: its bounds a, b. [m]
typedef struct Primitive {
  float4 a;
  float4 b;
  float4 c;
  uint kind;
} Primitive;

// What a tree is built over: triangles in order, then spheres, then shapes.
typedef struct Geometry {
  global const float* positions;
  global const uint4* triangles;  // the first of the tree
  global const Sphere* spheres;
  global const Shape* shapes;
  uint triangle_count;
  uint sphere_count;
} Geometry;

// In a kernel's parameter list, with a comma at the end; in its body.
#define HR_GEOMETRY_PARAMETERS                                                                               \
  global const float *restrict positions, global const uint4 *restrict triangles,                            \
      global const Sphere *restrict spheres, global const Shape *restrict shapes, const uint triangle_count, \
      const uint sphere_count,
#define HR_MAKE_GEOMETRY(first_triangle) \
  const Geometry geometry = {positions, triangles + (first_triangle), spheres, shapes, triangle_count, sphere_count};

static inline bool is_finite4(float4 v) { return isfinite(v.x) && isfinite(v.y) && isfinite(v.z); }

static inline float4 vertex_at(global const float* positions, uint i) {
  return (float4)(positions[3 * i], positions[3 * i + 1], positions[3 * i + 2], 0.0f);
}

static inline Primitive load_primitive(const Geometry* g, uint primitive) {
  Primitive p;
  if (primitive < g->triangle_count) {
    const uint4 i = g->triangles[primitive];
    p.a = vertex_at(g->positions, i.x);
    p.b = vertex_at(g->positions, i.y);
    p.c = vertex_at(g->positions, i.z);
    p.kind = HR_PRIMITIVE_TRIANGLE;
  } else if (primitive - g->triangle_count < g->sphere_count) {
    const float4 s = g->spheres[primitive - g->triangle_count].center_radius;
    p.a = (float4)(s.x, s.y, s.z, 0.0f);
    p.b = (float4)(s.w, 0.0f, 0.0f, 0.0f);
    p.c = (float4)(0.0f);
    p.kind = HR_PRIMITIVE_SPHERE;
  } else {
    global const Shape* shape = g->shapes + (primitive - g->triangle_count - g->sphere_count);
    p.a = shape->lo;
    p.b = shape->hi;
    p.c = (float4)(0.0f);
    p.kind = HR_PRIMITIVE_SHAPE;
  }
  return p;
}

// A lane without primitive: NaN, which no ray meets.
static inline Primitive no_primitive(void) {
  const Primitive none = {(float4)(NAN), (float4)(NAN), (float4)(NAN), HR_PRIMITIVE_SPHERE};
  return none;
}

// The box of a sphere is rounded outwards by an ulp of its largest coordinate, that of a shape by the host.
static inline Box primitive_box(Primitive p) {
  Box box;
  if (p.kind == HR_PRIMITIVE_SHAPE) {
    box.lo = p.a;
    box.hi = p.b;
  } else if (p.kind == HR_PRIMITIVE_TRIANGLE) {
    box.lo = min(min(p.a, p.b), p.c);
    box.hi = max(max(p.a, p.b), p.c);
  } else {
    const float4 pad = (fabs(p.a) + p.b.x) * (2.0f * (float)HR_HALF_ULP);
    box.lo = p.a - p.b.x - pad;
    box.hi = p.a + p.b.x + pad;
  }
  box.lo.w = 0.0f;
  box.hi.w = 0.0f;
  return box;
}

// Slow but sure: in units that are a power of two, so without rounding: the area of a tiny triangle must not underflow,
// that of a line must be zero.
static inline uint primitive_status_exact(Primitive p, Box box) {
#pragma OPENCL FP_CONTRACT OFF
  if (!is_finite4(p.a) || !is_finite4(p.b) || !is_finite4(p.c) || !is_finite4(box.lo + box.hi)) {
    return HR_PRIMITIVE_NON_FINITE;
  }
  if (p.kind == HR_PRIMITIVE_SHAPE) return HR_PRIMITIVE_VALID;
  if (p.kind == HR_PRIMITIVE_SPHERE) return p.b.x > 0 ? HR_PRIMITIVE_VALID : HR_PRIMITIVE_DEGENERATE;
  const real3 a = (real3)(p.a.x, p.a.y, p.a.z);
  const real3 e1 = (real3)(p.b.x, p.b.y, p.b.z) - a;
  const real3 e2 = (real3)(p.c.x, p.c.y, p.c.z) - a;
  const real3 largest = max(fabs(e1), fabs(e2));
  const real scale = as_float(as_uint(max_component(largest)) & 0x7f800000u);
  if (!(scale > 0)) return HR_PRIMITIVE_DEGENERATE;
  const real3 f1 = divide3(e1, scale), f2 = divide3(e2, scale);
  const real3 left = (real3)(f1.y * f2.z, f1.z * f2.x, f1.x * f2.y);
  const real3 right = (real3)(f1.z * f2.y, f1.x * f2.z, f1.y * f2.x);
  return left.x != right.x || left.y != right.y || left.z != right.z ? HR_PRIMITIVE_VALID : HR_PRIMITIVE_DEGENERATE;
}

// A triangle whose normal has a length in the middle of float's range is valid; anything else is looked at closely.
static inline uint primitive_status(Primitive p, Box box) {
#pragma OPENCL FP_CONTRACT OFF
  const float4 e1 = p.b - p.a, e2 = p.c - p.a;
  const float4 n = (float4)(e1.y * e2.z - e1.z * e2.y, e1.z * e2.x - e1.x * e2.z, e1.x * e2.y - e1.y * e2.x, 0.0f);
  const float4 sum = box.lo + box.hi;
  const float area2 = n.x * n.x + n.y * n.y + n.z * n.z + 0.0f * (sum.x + sum.y + sum.z);
  if (p.kind == HR_PRIMITIVE_TRIANGLE && area2 > 1e-30f && area2 < 1e30f) return HR_PRIMITIVE_VALID;
  return primitive_status_exact(p, box);
}

#endif
