// Which sides see each other, by a ray a pair: from centroid to centroid. Bit matrices, a bit a pair.
#include "lib/offset.h"
#include "radiosity/aimed_rays.h"
#include "radiosity/pair_sides.h"

#define HR_BLOCK_COLUMNS 64u /* = HR_SIDE_PADDING */

// For i < j: `visible` and `hidden` tell what the ray between them found; `cut` has those pairs that are
// close for their size, or face each other in part, but not with their centroids: no one ray tells about them. Zero
// elsewhere. Launch: a row of `stride` / HR_BLOCK_COLUMNS items a side, from side `first` on.
kernel __attribute__((reqd_work_group_size(HR_LOCAL_SIZE, 1, 1))) void radiosity_trace_pairs(
    HR_SCENE_PARAMETERS global const float* restrict sides, global const uint* restrict own_blockers,
    const uint stride, const uint count, const float flatness, const uint first, const uint row_count,
    global uint* restrict visible, global uint* restrict hidden, global uint* restrict cut, global uint* restrict rays,
    const RenderParams params) {
  const uint blocks = stride / HR_BLOCK_COLUMNS;
  const uint at = (uint)get_global_id(0) / blocks;
  if (at >= row_count) return;
  const uint i = first + at, begin = (uint)get_global_id(0) % blocks * HR_BLOCK_COLUMNS;
  uint words[3][2] = {{0, 0}, {0, 0}, {0, 0}};
  uint traced = 0;
  if (begin + HR_BLOCK_COLUMNS > i + 1) {
    HR_MAKE_SCENE_VIEW(params)
    const PairRow row = load_pair_row(sides, stride, i);
    const real3 center = (real3)(row.center[0], row.center[1], row.center[2]),
                normal = (real3)(row.normal[0], row.normal[1], row.normal[2]);
    const real3 origin = offset_origin(center, (real3)((real)flatness), normal, normal);
    AimedRays aimed;
    for (uint part = 0; part < HR_BLOCK_COLUMNS; part += HR_AIMED) {
      ulong asked = 0;
      aim_from(&aimed, origin, normal, own_blockers[i]);
      for (uint lane = 0; lane < min((uint)HR_AIMED, HR_BLOCK_COLUMNS - part); lane += 16) {
        const uint j0 = begin + part + lane;
        const PairColumns p = load_pair_columns(sides, stride, &row, j0, flatness);
        if (!any_lane16(p.facing)) continue;
        const int16 open = p.facing & (p.height > 0.0f) & (p.row_height > 0.0f);
        // One ray cannot stand for sides that are close for their size.
        const float16 reach = HR_PAIR_MIDDLE * (HR_SIDE_VALUES(HR_SIDE_RADIUS, j0) + row.radius);
        const int16 close = p.facing & (p.distance2 < reach * reach);
        const int *facing = (const int*)&p.facing, *aims = (const int*)&open, *closes = (const int*)&close;
        const float *x = (const float*)&p.away[0], *y = (const float*)&p.away[1], *z = (const float*)&p.away[2];
        const float* heights = (const float*)&p.row_height;
        for (uint k = 0; k < 16; k++) {
          const uint j = j0 + k, bit = part + lane + k;
          if (j <= i || !facing[k]) continue;
          if (!aims[k] || closes[k]) words[2][bit / 32] |= 1u << bit % 32;
          if (!aims[k]) continue;
          aim_at(&aimed, lane + k, center + (real3)(x[k], y[k], z[k]), way_to(heights[k], flatness));
          asked |= 1ul << (lane + k);
        }
      }
      if (asked == 0) continue;
      traced += popcount((uint)asked) + popcount((uint)(asked >> 32));
      trace_aimed(&view, &aimed);
      for (uint lane = 0; lane < min((uint)HR_AIMED, HR_BLOCK_COLUMNS - part); lane++) {
        if (!(asked >> lane & 1ul)) continue;
        const uint bit = part + lane;
        words[is_blocked(&aimed, lane) ? 1 : 0][bit / 32] |= 1u << bit % 32;
      }
    }
  }
  const ulong out = ((ulong)i * stride + begin) / 32;
  for (uint w = 0; w < 2; w++) {
    visible[out + w] = words[0][w];
    hidden[out + w] = words[1][w];
    cut[out + w] = words[2][w];
  }
  rays[at * blocks + begin / HR_BLOCK_COLUMNS] = traced;
}
