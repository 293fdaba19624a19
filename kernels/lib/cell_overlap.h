// Does a primitive touch a cell? Always yes where it does; rounding may only add cells. Triangles by separating axes
// (Akenine-Möller 2001, "Fast 3D Triangle-Box Overlap Testing"), spheres by their surface, shapes by their boxes, which
// the caller compares.
#ifndef HR_LIB_CELL_OVERLAP_H
#define HR_LIB_CELL_OVERLAP_H

#include "lib/primitive.h"

// Spheres count as smaller and larger than they are by this share of the radius: rounding in intersect_sphere().
#define HR_SPHERE_SLACK 1e-5f

// More than a dozen roundings of what is at most the product of three vectors' largest components, times 3.
#define HR_NORMAL_SLACK 4e-6f

static inline float largest(float4 v) { return max(max(fabs(v.x), fabs(v.y)), fabs(v.z)); }

// Axis e x (unit vector): the triangle's extent along it against the box's, h x (|e| along the two other axes).
static inline bool is_between(float p, float q, float r) { return min(p, q) <= r && max(p, q) >= -r; }

// a, b, c: vertices from the box's centre; h: half its size. Boxes are compared by the caller.
static inline bool triangle_touches_box(float4 a, float4 b, float4 c, float4 h) {
  const float4 edges[3] = {b - a, c - b, a - c};
  const float4 ends[3] = {a, b, c};
  const float4 opposite[3] = {c, a, b};
  for (uint i = 0; i < 3; i++) {
    const float4 e = edges[i], f = fabs(e), p = ends[i], q = opposite[i];
    if (!is_between(e.z * p.y - e.y * p.z, e.z * q.y - e.y * q.z, f.z * h.y + f.y * h.z)) return false;
    if (!is_between(e.x * p.z - e.z * p.x, e.x * q.z - e.z * q.x, f.x * h.z + f.z * h.x)) return false;
    if (!is_between(e.y * p.x - e.x * p.y, e.y * q.x - e.x * q.y, f.y * h.x + f.x * h.y)) return false;
  }
  // The normal of a sliver is mostly rounding: its error is bounded by the edges, not by its length.
  const float4 n = cross(edges[0], edges[1]);
  const float error = HR_NORMAL_SLACK * largest(edges[0]) * largest(edges[1]) * largest(a);
  return fabs(n.x * a.x + n.y * a.y + n.z * a.z) <= fabs(n.x) * h.x + fabs(n.y) * h.y + fabs(n.z) * h.z + error;
}

// A box of no more than the sphere's inside holds none of its surface.
static inline bool sphere_touches_box(float4 centre, float radius, float4 h) {
  const float4 outside = max(fabs(centre) - h, (float4)(0.0f));
  const float4 farthest = fabs(centre) + h;
  const float most = radius * (1.0f + HR_SPHERE_SLACK), least = radius * (1.0f - HR_SPHERE_SLACK);
  return outside.x * outside.x + outside.y * outside.y + outside.z * outside.z <= most * most &&
         farthest.x * farthest.x + farthest.y * farthest.y + farthest.z * farthest.z >= least * least;
}

static inline bool boxes_touch(Box a, Box b) {
  return a.lo.x <= b.hi.x && a.hi.x >= b.lo.x && a.lo.y <= b.hi.y && a.hi.y >= b.lo.y && a.lo.z <= b.hi.z &&
         a.hi.z >= b.lo.z;
}

// `cell` has been widened on all sides by what rounding of rays, of hits and in here may amount to. In units of about
// the cell's and the primitive's size, so that nothing overflows.
static inline bool primitive_touches_cell(Primitive p, Box cell, float unit) {
  if (p.kind == HR_PRIMITIVE_SHAPE) return true;
  const float inverse = 1.0f / unit;
  const float4 centre = 0.5f * cell.lo + 0.5f * cell.hi;
  float4 h = (cell.hi - cell.lo) * (0.5f * inverse);
  h.w = 0.0f;
  const float4 a = (p.a - centre) * inverse;
  if (p.kind == HR_PRIMITIVE_SPHERE) return sphere_touches_box(a, p.b.x * inverse, h);
  return triangle_touches_box(a, (p.b - centre) * inverse, (p.c - centre) * inverse, h);
}

#endif
