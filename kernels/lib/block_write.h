// A primitive's geometry into its lane of a leaf's block (shared/bvh_types.h).
#ifndef HR_LIB_BLOCK_WRITE_H
#define HR_LIB_BLOCK_WRITE_H

#include "lib/accel_layout.h"
#include "lib/primitive.h"

static inline void write_lane(global float* block, uint lane, Primitive p, bool is_triangle, uint primitive) {
  if (is_triangle && !HR_TRIANGLE_WATERTIGHT) {
    const float4 e1 = p.a - p.b, e2 = p.c - p.a;
    p.b = e1;
    p.c = e2;
  }
  const float rows[9] = {p.a.x, p.a.y, p.a.z, p.b.x, p.b.y, p.b.z, p.c.x, p.c.y, p.c.z};
  for (uint r = 0; r < 9; r++) block[r * HR_L + lane] = rows[r];
  ((global uint*)block)[HR_BLOCK_PRIMITIVE_ROW * HR_L + lane] = primitive;
}

#endif
