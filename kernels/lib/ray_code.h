// Where a ray starts and which way it goes, as one number: rays with neighbouring codes meet the same parts of the
// tree.
#ifndef HR_LIB_RAY_CODE_H
#define HR_LIB_RAY_CODE_H

#include "shared/scalar.h"

#define HR_RAY_CODE_BITS 21 /* 4 an axis of the origin, 3 an axis of the direction */

static inline uint interleave(uint4 cell, uint axis_bits) {
  uint code = 0;
  for (uint b = axis_bits; b-- > 0;) {
    code = code << 3 | (cell.x >> b & 1u) << 2 | (cell.y >> b & 1u) << 1 | (cell.z >> b & 1u);
  }
  return code;
}

// lo: of the scene's bounds [m]; scale: cells per metre.
static inline uint ray_code(float4 origin, float4 direction, float4 lo, float4 scale) {
  const float largest = max(max(fabs(direction.x), fabs(direction.y)), fabs(direction.z));
  const float4 from = max((float4)(0.0f), min((float4)(15.0f), (origin - lo) * scale));
  const float4 way = max((float4)(0.0f), min((float4)(7.0f), (direction / largest) * 4.0f + 4.0f));
  return interleave(convert_uint4(from), 4) << 9 | interleave(convert_uint4(way), 3);
}

#endif
