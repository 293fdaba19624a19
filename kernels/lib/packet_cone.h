// The pyramid that holds all rays of a packet, to leave out a block's triangles beside it at once (Reshetov, Soupikov,
// Hurley 2005, "Multi-Level Ray Tracing Algorithm").
#ifndef HR_LIB_PACKET_CONE_H
#define HR_LIB_PACKET_CONE_H

#include "lib/leaf_block.h"
#include "lib/packet_rays.h"

// Slopes are rounded twice, and hits lie within some ulps of |vertex - origin| of the triangle (intersect.h).
#define HR_CONE_SLACK 4e-6f

// Rays have direction_k / |direction_z| in [lo_k, hi_k] for the axes k = x, y beside z, the axis along which all go one
// way.
typedef struct PacketCone {
  int kz;      // -1: there is no such axis
  float sign;  // of the directions along it
  float lo_x, hi_x, lo_y, hi_y;
} PacketCone;

static inline void slopes_along(const float16* d, const float16* rate, float sign, float* lo, float* hi) {
  float16 least = d[0] * rate[0], most = least;
  for (uint k = 1; k < HR_K; k++) {
    least = min(least, d[k] * rate[k]);
    most = max(most, d[k] * rate[k]);
  }
  const float a = sign * least_of16(least), b = sign * most_of16(most);
  const float slack = HR_CONE_SLACK * (1 + max(fabs(a), fabs(b)));
  *lo = min(a, b) - slack;
  *hi = max(a, b) + slack;
}

static inline PacketCone packet_cone(const Packet* p) {
  PacketCone cone = {-1, 1, 0, 0, 0, 0};
  float best = 0;
  for (int axis = 0; axis < 3; axis++) {
    const float nearest = max(p->least[axis], -p->most[axis]);  // > 0: no direction is nearer to zero along it
    if (nearest > best) {
      best = nearest;
      cone.kz = axis;
      cone.sign = p->least[axis] > 0 ? 1 : -1;
    }
  }
  if (cone.kz < 0) return cone;
  const float16* d[3] = {p->dx, p->dy, p->dz};
  const float16* rate[3] = {p->rx, p->ry, p->rz};
  const int kx = cone.kz == 2 ? 0 : cone.kz + 1, ky = kx == 2 ? 0 : kx + 1;
  slopes_along(d[kx], rate[cone.kz], cone.sign, &cone.lo_x, &cone.hi_x);
  slopes_along(d[ky], rate[cone.kz], cone.sign, &cone.lo_y, &cone.hi_y);
  return cone;
}

static inline HR_FLOATL least_of_three(HR_FLOATL a, HR_FLOATL b, HR_FLOATL c) { return min(min(a, b), c); }
static inline HR_FLOATL most_of_three(HR_FLOATL a, HR_FLOATL b, HR_FLOATL c) { return max(max(a, b), c); }

// Triangles of a block (three vertices each) that do not lie behind the origin, nor wholly beyond one of the pyramid's
// sides.
static inline LaneSet lanes_in_cone(const PacketCone* c, real3 origin, global const float* block) {
  const int kx = c->kz == 2 ? 0 : c->kz + 1, ky = kx == 2 ? 0 : kx + 1;
  const float ox = pick(origin, kx), oy = pick(origin, ky), oz = pick(origin, c->kz);
  const HR_FLOATL ax = HR_ROW(kx) - ox, ay = HR_ROW(ky) - oy, az = (HR_ROW(c->kz) - oz) * c->sign;
  const HR_FLOATL bx = HR_ROW(3 + kx) - ox, by = HR_ROW(3 + ky) - oy, bz = (HR_ROW(3 + c->kz) - oz) * c->sign;
  const HR_FLOATL cx = HR_ROW(6 + kx) - ox, cy = HR_ROW(6 + ky) - oy, cz = (HR_ROW(6 + c->kz) - oz) * c->sign;
  return HR_LANES_OF_L((most_of_three(az, bz, cz) >= 0.0f) &
                       (least_of_three(ax - c->hi_x * az, bx - c->hi_x * bz, cx - c->hi_x * cz) <= 0.0f) &
                       (most_of_three(ax - c->lo_x * az, bx - c->lo_x * bz, cx - c->lo_x * cz) >= 0.0f) &
                       (least_of_three(ay - c->hi_y * az, by - c->hi_y * bz, cy - c->hi_y * cz) <= 0.0f) &
                       (most_of_three(ay - c->lo_y * az, by - c->lo_y * bz, cy - c->lo_y * cz) >= 0.0f));
}

#endif
