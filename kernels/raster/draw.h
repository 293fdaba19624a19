// Triangles into a picture of ids with depth, seen from a point. Nothing is projected and nothing clipped: edge
// functions and depth are homogeneous, so a triangle may reach behind the point (Olano and Greer 1997, "Triangle Scan
// Conversion using 2D Homogeneous Coordinates").
#ifndef HR_RASTER_DRAW_H
#define HR_RASTER_DRAW_H

#include "raster/lanes.h"
#include "shared/radiosity_types.h"

// A triangle's cells are sought this far around it, which covers the rounding of its projected vertices.
#define HR_RECTANGLE_SLACK 0.015625f  // [cells]

// What is seen from `origin` in the directions along p + up q + out, p in [-1, 1], q in [low, 1], through the middles
// of `width` x `height` cells.
typedef struct View {
  real3 origin, along, up, out;
  float low;
  float step;    // of p and q, a cell
  float scale;   // 1 / step
  float parity;  // -1: along, up, out are left-handed
  uint width, height;
  uint stride;          // of rows of cells, a multiple of HR_LANES
  global float* depth;  // 1 / t of what is seen in direction t (along p + up q + out); 0: nothing
  global int* item;     // its side
} View;

// Triangles as seen in the frame (along, up, out), and the cells that they may cover.
typedef struct Seen {
  Lanes ax, ay, az, bx, by, bz, cx, cy, cz;
  Lanes slope_p, slope_q, level;  // 1 / t of a triangle's plane at (p, q)
  Lanes deepest, nearest;         // 1 / t of its vertices, if all lie in front
  Lanes x0, x1, y0, y1;
  Lanes facing;  // < 0: its front is seen
} Seen;

static inline Lanes along_axis(Lanes x, Lanes y, Lanes z, real3 axis) {
  return fma(x, (Lanes)(axis.x), fma(y, (Lanes)(axis.y), z * (Lanes)(axis.z)));
}

// Rounds alike for all triangles that share a vertex: no gap opens between them.
static inline void to_frame(const View* v, global const float* corner, Lanes* x, Lanes* y, Lanes* z) {
  const Lanes dx = load_lanes(corner) - v->origin.x, dy = load_lanes(corner + 16) - v->origin.y,
              dz = load_lanes(corner + 32) - v->origin.z;
  *x = along_axis(dx, dy, dz, v->along);
  *y = along_axis(dx, dy, dz, v->up);
  *z = along_axis(dx, dy, dz, v->out);
}

static inline Lanes first_cell_from(Lanes p, float scale, float end) {
  return clamp(ceil(p * scale - (0.5f + HR_RECTANGLE_SLACK)), (Lanes)(0.0f), (Lanes)(end));
}

static inline Lanes last_cell_to(Lanes p, float scale, float end) {
  return clamp(floor(p * scale - (0.5f - HR_RECTANGLE_SLACK)), (Lanes)(-1.0f), (Lanes)(end - 1));
}

// `corners`: three vertices, an axis a row of 16 triangles. Which of them may be seen.
static inline LaneMask see_triangles(const View* v, global const float* corners, Seen* s) {
  to_frame(v, corners, &s->ax, &s->ay, &s->az);
  to_frame(v, corners + 48, &s->bx, &s->by, &s->bz);
  to_frame(v, corners + 96, &s->cx, &s->cy, &s->cz);
  const Lanes near = least_of(s->az, s->bz, s->cz), far = most_of(s->az, s->bz, s->cz);
  LaneMask may = (far > 0) & (least_of(s->ax - s->az, s->bx - s->bz, s->cx - s->cz) < 0) &
                 (most_of(s->ax + s->az, s->bx + s->bz, s->cx + s->cz) > 0) &
                 (least_of(s->ay - s->az, s->by - s->bz, s->cy - s->cz) < 0) &
                 (most_of(s->ay - v->low * s->az, s->by - v->low * s->bz, s->cy - v->low * s->cz) > 0);
  if (!any_lane(may)) return may;
  const Lanes ux = s->bx - s->ax, uy = s->by - s->ay, uz = s->bz - s->az;
  const Lanes vx = s->cx - s->ax, vy = s->cy - s->ay, vz = s->cz - s->az;
  const Lanes nx = uy * vz - uz * vy, ny = uz * vx - ux * vz, nz = ux * vy - uy * vx;
  const Lanes volume = nx * s->ax + ny * s->ay + nz * s->az;
  const Lanes scale = 1 / volume;
  s->slope_p = nx * scale;
  s->slope_q = ny * scale;
  s->level = nz * scale;
  s->facing = volume * v->parity;
  may &= volume != 0;

  // One that reaches behind the point may cover any cell.
  const LaneMask in_front = near > 0;
  s->deepest = select((Lanes)(0.0f), 1 / far, in_front);
  s->nearest = select((Lanes)(INFINITY), 1 / near, in_front);
  const Lanes ia = 1 / s->az, ib = 1 / s->bz, ic = 1 / s->cz;
  const Lanes pa = s->ax * ia, pb = s->bx * ib, pc = s->cx * ic, qa = s->ay * ia, qb = s->by * ib, qc = s->cy * ic;
  const float w = (float)v->width, h = (float)v->height;
  s->x0 = select((Lanes)(0.0f), first_cell_from(least_of(pa, pb, pc) + 1, v->scale, w), in_front);
  s->x1 = select((Lanes)(w - 1), last_cell_to(most_of(pa, pb, pc) + 1, v->scale, w), in_front);
  s->y0 = select((Lanes)(0.0f), first_cell_from(least_of(qa, qb, qc) - v->low, v->scale, h), in_front);
  s->y1 = select((Lanes)(h - 1), last_cell_to(most_of(qa, qb, qc) - v->low, v->scale, h), in_front);
  return may & (s->x0 <= s->x1) & (s->y0 <= s->y1);
}

// Triangle `lane` of those seen, as side `side`, into the picture. Vertices are sheared along each cell's direction,
// products rounded alike on both sides of an edge and zeros settled exactly, as in intersect.h. Ties at equal depth go
// to the smaller side, so the order in which triangles come does not matter.
static inline void draw_triangle(const View* v, const Seen* s, uint lane, int side) {
#pragma OPENCL FP_CONTRACT OFF
  const float ax0 = lane_of(&s->ax, lane), ay0 = lane_of(&s->ay, lane), az = lane_of(&s->az, lane);
  const float bx0 = lane_of(&s->bx, lane), by0 = lane_of(&s->by, lane), bz = lane_of(&s->bz, lane);
  const float cx0 = lane_of(&s->cx, lane), cy0 = lane_of(&s->cy, lane), cz = lane_of(&s->cz, lane);
  const float slope_p = lane_of(&s->slope_p, lane);
  const Lanes deepest = (Lanes)(lane_of(&s->deepest, lane)), nearest = (Lanes)(lane_of(&s->nearest, lane));
  const uint x0 = (uint)lane_of(&s->x0, lane) / HR_LANES * HR_LANES, x1 = (uint)lane_of(&s->x1, lane);
  const uint y1 = (uint)lane_of(&s->y1, lane);
  for (uint y = (uint)lane_of(&s->y0, lane); y <= y1; y++) {
    const float q = ((float)y + 0.5f) * v->step + v->low;
    const Lanes ay = (Lanes)(fma(-q, az, ay0)), by = (Lanes)(fma(-q, bz, by0)), cy = (Lanes)(fma(-q, cz, cy0));
    const float level = fma(lane_of(&s->slope_q, lane), q, lane_of(&s->level, lane));
    for (uint x = x0; x <= x1; x += HR_LANES) {
      const Lanes p = (lane_numbers() + ((float)x + 0.5f)) * v->step - 1;
      const Lanes ax = fma(-p, (Lanes)(az), (Lanes)(ax0)), bx = fma(-p, (Lanes)(bz), (Lanes)(bx0)),
                  cx = fma(-p, (Lanes)(cz), (Lanes)(cx0));
      Lanes wa = cx * by - cy * bx;
      Lanes wb = ax * cy - ay * cx;
      Lanes wc = bx * ay - by * ax;
      LaneMask covered = all_of_one_sign(wa, wb, wc);
      if (!any_lane(covered)) continue;
      if (any_lane(covered & ((wa == 0) | (wb == 0) | (wc == 0)))) {
        wa = exact_edge_lanes(cx, cy, bx, by);
        wb = exact_edge_lanes(ax, ay, cx, cy);
        wc = exact_edge_lanes(bx, by, ax, ay);
        covered &= all_of_one_sign(wa, wb, wc) & (wa + wb + wc != 0);
      }
      // A plane seen from its edge says anything: depth stays between the vertices'.
      const Lanes depth = clamp(fma((Lanes)(slope_p), p, (Lanes)(level)), deepest, nearest);
      global float* depths = v->depth + y * v->stride + x;
      global int* items = v->item + y * v->stride + x;
      const Lanes before = load_lanes(depths);
      const LaneMask item = load_items(items);
      covered &= (depth > before) | ((depth == before) & (depth > 0) & ((LaneMask)(side) < item));
      if (!any_lane(covered)) continue;
      store_lanes(select(before, depth, covered), depths);
      store_items(select(item, (LaneMask)(side), covered), items);
    }
  }
}

#endif
