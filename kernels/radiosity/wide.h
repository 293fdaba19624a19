// As many columns or rays as one item does at once: 16 as a vector, or one where the device runs an item a lane.
#ifndef HR_RADIOSITY_WIDE_H
#define HR_RADIOSITY_WIDE_H

#include "lib/accel_layout.h"
#include "lib/lanes.h"

// Masks come from comparisons, whose truth is -1 in a lane of a vector but 1 in a scalar: they are joined by & and |,
// turned over by no_lanes(), and only used by choose() and any_lane().
#if HR_EXPLICIT_VECTORS

#define HR_P 16u
typedef float16 floatp;
typedef int16 intp;
typedef uint16 uintp;
#define HR_LANE_NUMBERS ((uint16)(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15))
static inline floatp load_lanes(global const float* p) { return vload16(0, p); }
static inline void store_lanes(floatp a, global float* p) { vstore16(a, 0, p); }
static inline floatp floats_of(uintp a) { return convert_float16(a); }
static inline bool any_lane(intp mask) { return any_lane16(mask); }
static inline intp no_lanes(intp mask) { return ~mask; }
static inline floatp choose(floatp otherwise, floatp then, intp mask) { return select(otherwise, then, mask); }
static inline float sum_lanes(floatp a) {
  const float8 b = a.lo + ((const float8*)&a)[1];
  const float4 c = b.lo + b.hi;
  return (c.x + c.z) + (c.y + c.w);
}

#else

#define HR_P 1u
typedef float floatp;
typedef int intp;
typedef uint uintp;
#define HR_LANE_NUMBERS 0u
static inline floatp load_lanes(global const float* p) { return *p; }
static inline void store_lanes(floatp a, global float* p) { *p = a; }
static inline floatp floats_of(uintp a) { return (float)a; }
static inline bool any_lane(intp mask) { return mask != 0; }
static inline intp no_lanes(intp mask) { return !mask; }
static inline floatp choose(floatp otherwise, floatp then, intp mask) { return mask ? then : otherwise; }
static inline float sum_lanes(floatp a) { return a; }

#endif

static inline floatp dot_lanes(floatp ax, floatp ay, floatp az, floatp bx, floatp by, floatp bz) {
  return fma(ax, bx, fma(ay, by, az * bz));
}

#endif
