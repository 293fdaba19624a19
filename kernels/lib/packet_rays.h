// A packet of rays from one origin: how it is filled and what it holds. HR_PACKET_GROUPS x 16 rays, a vector a group.
#ifndef HR_LIB_PACKET_RAYS_H
#define HR_LIB_PACKET_RAYS_H

#include "lib/accel_layout.h"
#include "lib/intersect.h"
#include "lib/lanes.h"

#if HR_EXPLICIT_VECTORS

#ifndef HR_PACKET_GROUPS
#define HR_PACKET_GROUPS 4
#endif
#define HR_K HR_PACKET_GROUPS
#define HR_PACKET_RAYS (16 * HR_K)

typedef struct Packet {
  float16 dx[HR_K], dy[HR_K], dz[HR_K];  // directions
  float16 rx[HR_K], ry[HR_K], rz[HR_K];  // their reciprocals
  float16 t[HR_K], u[HR_K], v[HR_K];     // closest hits so far; t starts at t_max, and is below all for lanes unused
  int16 primitive[HR_K];                 // or HR_NO_PRIMITIVE
  int16 skip[HR_K];                      // the primitive that a ray does not meet, or HR_NO_PRIMITIVE
  uint members[HR_K];                    // a bit a lane in use
#if HR_TRIANGLE_WATERTIGHT
  float16 sx[HR_K], sy[HR_K], sz[HR_K];  // shear, each ray's along the axis that is longest for it, as in make_ray()
  int16 axis[HR_K];                      // that axis
  uint axes[HR_K], all_axes;             // a bit an axis that is some ray's
#endif
  real3 origin;
  float t_min, t_most;      // t_most: largest t of all rays
  float least[3], most[3];  // of the directions' components
} Packet;

static inline float least_of16(float16 a) {
  const float8 b = min(a.lo, as_float8(upper_lanes(as_int16(a))));
  const float4 c = min(b.lo, b.hi);
  const float2 d = min(c.lo, c.hi);
  return min(d.x, d.y);
}

static inline float most_of16(float16 a) { return -least_of16(-a); }

// A packet without rays; `direction`: any of those that will come.
static inline void open_packet(Packet* p, real3 origin, real t_min, real3 direction) {
  p->origin = origin;
  p->t_min = t_min;
  for (uint k = 0; k < HR_K; k++) {
    p->dx[k] = (float16)(direction.x);
    p->dy[k] = (float16)(direction.y);
    p->dz[k] = (float16)(direction.z);
    p->t[k] = (float16)(-1.0f);
    p->u[k] = (float16)(0.0f);
    p->v[k] = (float16)(0.0f);
    p->primitive[k] = (int16)(-1);
    p->skip[k] = (int16)(-1);
    p->members[k] = 0;
  }
}

static inline void put_ray(Packet* p, uint ray, real3 direction, real t_max, uint skip) {
  ((float*)p->dx)[ray] = direction.x;
  ((float*)p->dy)[ray] = direction.y;
  ((float*)p->dz)[ray] = direction.z;
  ((float*)p->t)[ray] = t_max;
  ((int*)p->skip)[ray] = (int)skip;
  p->members[ray / 16] |= 1u << ray % 16;
}

static inline bool is_in_packet(const Packet* p, uint ray) { return (p->members[ray / 16] >> ray % 16 & 1u) != 0; }

static inline Hit packet_hit(const Packet* p, uint ray) {
  const Hit hit = {((const float*)p->t)[ray], ((const float*)p->u)[ray], ((const float*)p->v)[ray],
                   ((const uint*)p->primitive)[ray]};
  return hit;
}

static inline float16 safe_reciprocal16(float16 d) {
  const float16 tiny = (float16)(HR_TINY_DIRECTION);
  return 1.0f / select(d, copysign(tiny, d), fabs(d) < tiny);
}

#if HR_TRIANGLE_WATERTIGHT

static inline float16 pick16(float16 x, float16 y, float16 z, int16 axis) {
  return select(select(x, y, axis == 1), z, axis == 2);
}

// The rays' own axes, so that what a ray meets does not depend on the others in its packet. kx, ky follow kz in order:
// where make_ray() swaps them, only the sign of all edge functions changes.
static inline void shear_packet(Packet* p) {
  p->all_axes = 0;
  for (uint k = 0; k < HR_K; k++) {
    const float16 dx = p->dx[k], dy = p->dy[k], dz = p->dz[k];
    const float16 x = fabs(dx), y = fabs(dy), z = fabs(dz);
    const int16 is_x = (x > y) & (x > z), is_y = ~(x > y) & (y > z);
    const int16 axis = select(select((int16)(2), (int16)(1), is_y), (int16)(0), is_x);
    p->axis[k] = axis;
    p->axes[k] = (any_lane16(is_x) ? 1u : 0u) | (any_lane16(is_y) ? 2u : 0u) | (any_lane16(axis == 2) ? 4u : 0u);
    p->all_axes |= p->axes[k];
    p->sz[k] = pick16(p->rx[k], p->ry[k], p->rz[k], axis);
    p->sx[k] = -(pick16(dy, dz, dx, axis) * p->sz[k]);
    p->sy[k] = -(pick16(dz, dx, dy, axis) * p->sz[k]);
  }
}

#endif

// What all rays share, once they are in.
static inline void close_packet(Packet* p) {
  float16 lo_x = p->dx[0], lo_y = p->dy[0], lo_z = p->dz[0], hi_x = lo_x, hi_y = lo_y, hi_z = lo_z;
  for (uint k = 0; k < HR_K; k++) {
    lo_x = min(lo_x, p->dx[k]);
    lo_y = min(lo_y, p->dy[k]);
    lo_z = min(lo_z, p->dz[k]);
    hi_x = max(hi_x, p->dx[k]);
    hi_y = max(hi_y, p->dy[k]);
    hi_z = max(hi_z, p->dz[k]);
    p->rx[k] = safe_reciprocal16(p->dx[k]);
    p->ry[k] = safe_reciprocal16(p->dy[k]);
    p->rz[k] = safe_reciprocal16(p->dz[k]);
  }
  p->least[0] = least_of16(lo_x);
  p->least[1] = least_of16(lo_y);
  p->least[2] = least_of16(lo_z);
  p->most[0] = most_of16(hi_x);
  p->most[1] = most_of16(hi_y);
  p->most[2] = most_of16(hi_z);
#if HR_TRIANGLE_WATERTIGHT
  shear_packet(p);
#endif
}

#endif

#endif
