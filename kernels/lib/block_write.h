// A primitive's geometry into its lane of a leaf's block (shared/bvh_types.h).
#ifndef HR_LIB_BLOCK_WRITE_H
#define HR_LIB_BLOCK_WRITE_H

#include "lib/accel_layout.h"
#include "lib/primitive.h"

static inline void write_lane(global float* block, uint lane, Primitive p, uint primitive) {
  if (!HR_TRIANGLE_WATERTIGHT && p.kind == HR_PRIMITIVE_TRIANGLE) {
    const float4 e1 = p.a - p.b, e2 = p.c - p.a;
    p.b = e1;
    p.c = e2;
  }
  block += lane;
  block[0] = p.a.x;
  block[HR_L] = p.a.y;
  block[2 * HR_L] = p.a.z;
  block[3 * HR_L] = p.b.x;
  block[4 * HR_L] = p.b.y;
  block[5 * HR_L] = p.b.z;
  block[6 * HR_L] = p.c.x;
  block[7 * HR_L] = p.c.y;
  block[8 * HR_L] = p.c.z;
  ((global uint*)block)[HR_BLOCK_PRIMITIVE_ROW * HR_L] = primitive;
}

#endif
