// Hemicubes by rasterisation (Cohen and Greenberg 1985, "The Hemi-Cube"): the patches are drawn on the five faces of a
// cube; the item buffer says whose each cell is.
#include "lib/chunk.h"
#include "lib/hemicube.h"
#include "raster/draw.h"

static inline View make_view(const Hemicube* h, uint face, uint n, global float* depth, global int* item) {
  const HemicubeFace f = hemicube_face(h, face, n);
  const View v = {h->origin,
                  f.along,
                  f.up,
                  f.out,
                  f.low,
                  2.0f / (float)n,
                  0.5f * (float)n,
                  dot3(cross3(f.along, f.up), f.out) < 0 ? -1.0f : 1.0f,
                  n,
                  f.rows,
                  (n + HR_LANES - 1) / HR_LANES * HR_LANES,
                  depth,
                  item};
  return v;
}

// Largest of `plane` over boxes, seen from the view's point.
static inline Lanes most_over_boxes(const View* v, global const float* bounds, real3 plane) {
  const Lanes x0 = load_lanes(bounds) - v->origin.x, x1 = load_lanes(bounds + 48) - v->origin.x;
  const Lanes y0 = load_lanes(bounds + 16) - v->origin.y, y1 = load_lanes(bounds + 64) - v->origin.y;
  const Lanes z0 = load_lanes(bounds + 32) - v->origin.z, z1 = load_lanes(bounds + 80) - v->origin.z;
  return max(x0 * plane.x, x1 * plane.x) + max(y0 * plane.y, y1 * plane.y) + max(z0 * plane.z, z1 * plane.z);
}

// Rounding is harmless: a cell's middle is part a cell away from the faces' ends.
static inline LaneMask boxes_in_view(const View* v, global const float* bounds) {
  return (most_over_boxes(v, bounds, v->out - v->along) > 0) & (most_over_boxes(v, bounds, v->out + v->along) > 0) &
         (most_over_boxes(v, bounds, v->out - v->up) > 0) &
         (most_over_boxes(v, bounds, v->up - v->out * (real)v->low) > 0);
}

static inline void draw_chunk(const View* v, global const float* corners, uint first, uint own) {
  for (uint at = 0; at < 16; at += HR_LANES) {
    Seen seen;
    const LaneMask may = see_triangles(v, corners + at, &seen);
    for (uint part = 0; part < HR_PARTS; part++) {
      for (LaneSet rest = lanes_of_part(may, part); rest; rest = without_first(rest)) {
        const uint lane = 8 * part + first_lane(rest);
        const uint triangle = first + at + lane;
        if (triangle == own) continue;
        draw_triangle(v, &seen, lane, (int)(2 * triangle + (lane_of(&seen.facing, lane) < 0 ? 0 : 1)));
      }
    }
  }
}

// seen[] as of radiosity_trace_hemicubes. `corners`: of chunks of 16 triangles, rows a.x to c.z of 16 each; `bounds`:
// of groups of 16 chunks, rows lo.x to hi.z, 16 each. `depths`, `items`: a face of n rows an item. Launch: G items.
kernel void raster_draw_hemicubes(global const float* restrict corners, global const float* restrict bounds,
                                  const uint groups_of_chunks, global const uint* restrict rows,
                                  global float* restrict depths, global int* restrict items, global uint* restrict seen,
                                  const HemicubeParams cube) {
  const uint g = (uint)get_global_id(0), workers = (uint)get_global_size(0);
  const uint n = cube.resolution, samples = cube.divisions * cube.divisions, faces = 5 * cube.row_count * samples;
  const uint end = chunk_begin(faces, g + 1, workers);
  for (uint at = chunk_begin(faces, g, workers); at < end; at++) {
    const uint which = at / 5, face = at % 5, side = rows[which / samples], own = side / 2;
    global const float* c = corners + (ulong)(own / 16) * 144 + own % 16;
    const Hemicube h = make_hemicube((real3)(c[0], c[16], c[32]), (real3)(c[48], c[64], c[80]),
                                     (real3)(c[96], c[112], c[128]), side, which % samples, &cube);
    View v = make_view(&h, face, n, depths, items);
    v.depth += (ulong)g * n * v.stride;
    v.item += (ulong)g * n * v.stride;
    for (uint i = 0; i < v.height * v.stride; i++) {
      v.depth[i] = 0;
      v.item[i] = (int)HR_NO_SIDE;
    }
    for (uint group = 0; group < groups_of_chunks; group++) {
      for (uint k = 0; k < 16; k += HR_LANES) {
        const LaneMask may = boxes_in_view(&v, bounds + (ulong)group * 96 + k);
        for (uint part = 0; part < HR_PARTS; part++) {
          for (LaneSet rest = lanes_of_part(may, part); rest; rest = without_first(rest)) {
            const uint chunk = 16 * group + k + 8 * part + first_lane(rest);
            draw_chunk(&v, corners + (ulong)chunk * 144, 16 * chunk, own);
          }
        }
      }
    }
    global uint* out = seen + which * (3 * n * n) + first_cell(face, n);
    for (uint y = 0; y < v.height; y++) {
      for (uint x = 0; x < n; x++) out[y * n + x] = (uint)v.item[y * v.stride + x];
    }
  }
}
