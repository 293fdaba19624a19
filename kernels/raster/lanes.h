// What a rasteriser does at once: 16 triangles, boxes or cells where the device has vectors, else one.
#ifndef HR_RASTER_LANES_H
#define HR_RASTER_LANES_H

#include "lib/edge_function.h"
#include "lib/lanes.h"

#if HR_EXPLICIT_VECTORS

#define HR_LANES 16u
#define HR_PARTS 2u
typedef float16 Lanes;
typedef int16 LaneMask;  // all bits or none
static inline Lanes lane_numbers(void) { return (float16)(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15); }
static inline Lanes load_lanes(global const float* p) { return vload16(0, p); }
static inline void store_lanes(Lanes v, global float* p) { vstore16(v, 0, p); }
static inline LaneMask load_items(global const int* p) { return vload16(0, p); }
static inline void store_items(LaneMask v, global int* p) { vstore16(v, 0, p); }
static inline bool any_lane(LaneMask m) { return any_lane16(m); }
static inline LaneSet lanes_of_part(LaneMask m, uint part) { return lanes_of8(part ? upper_lanes(m) : m.lo); }
static inline LaneMask all_of_one_sign(Lanes a, Lanes b, Lanes c) { return all_of_one_sign16(a, b, c); }
#define exact_edge_lanes exact_edge_function16

#else

#define HR_LANES 1u
#define HR_PARTS 1u
typedef float Lanes;
typedef int LaneMask;
static inline Lanes lane_numbers(void) { return 0; }
static inline Lanes load_lanes(global const float* p) { return *p; }
static inline void store_lanes(Lanes v, global float* p) { *p = v; }
static inline LaneMask load_items(global const int* p) { return *p; }
static inline void store_items(LaneMask v, global int* p) { *p = v; }
static inline bool any_lane(LaneMask m) { return m != 0; }
static inline LaneSet lanes_of_part(LaneMask m, uint part) { return m ? lane_bit(part) : 0; }
static inline LaneMask all_of_one_sign(Lanes a, Lanes b, Lanes c) {
  return (min(min(a, b), c) >= 0) | (max(max(a, b), c) <= 0);
}
#define exact_edge_lanes exact_edge_function

#endif

static inline Lanes least_of(Lanes a, Lanes b, Lanes c) { return min(min(a, b), c); }
static inline Lanes most_of(Lanes a, Lanes b, Lanes c) { return max(max(a, b), c); }
static inline float lane_of(const Lanes* v, uint lane) { return ((const float*)v)[lane]; }

#endif
