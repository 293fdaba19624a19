// The share of a partly hidden pair's exchange that gets through: rays between points of both, weighted by what is
// exchanged between them. Points follow a sequence that fills all four dimensions evenly (Roberts 2018, R_4), two for
// the row's side and two for the column's, so rays of a row to many sides start from one point together.
#include "lib/offset.h"
#include "lib/rng.h"
#include "radiosity/aimed_rays.h"
#include "radiosity/pair_sides.h"

#define HR_DIMENSION_PARTIAL 104u

// Powers of 1 / phi, phi^5 = phi + 1, in units of 2^-32.
constant uint r4_steps[4] = {3679390609u, 3152041523u, 2700274806u, 2313257605u};

#define HR_AIMED_GROUPS (HR_AIMED / 16)
#define HR_INVERSE_PI 0.318309886f

// Starting points of the sequence, in units of 2^-32: for the row's dimensions 0 and 1, or a column's 2 and 3.
static inline uint2 sequence_start(uint side, uint dimension, uint seed_key) {
  return rng_hash((uint4)(side, dimension, 0, HR_DIMENSION_PARTIAL ^ seed_key)).xy;
}

// A square onto a triangle, of little distortion (Heitz 2019): weights of the second and third corner.
static inline float2 onto_triangle(float u, float v) {
  return v > u ? (float2)(0.5f * u, v - 0.5f * u) : (float2)(u - 0.5f * v, 0.5f * v);
}

static inline float16 unit16(uint16 bits) { return convert_float16(bits >> 8) * 5.9604644775390625e-8f; }

static inline real3 row_of(global const float* sides, uint stride, uint row, uint i) {
  return (real3)(HR_SIDE_VALUE(row, i), HR_SIDE_VALUE(row + 1, i), HR_SIDE_VALUE(row + 2, i));
}

// The columns of a packet.
typedef struct Targets {
  float16 corner[3][HR_AIMED_GROUPS], edge1[3][HR_AIMED_GROUPS], edge2[3][HR_AIMED_GROUPS];
  float16 normal[3][HR_AIMED_GROUPS];
  uint16 start_u[HR_AIMED_GROUPS], start_v[HR_AIMED_GROUPS];
} Targets;

static inline void put_target(Targets* t, uint lane, global const float* sides, uint stride, uint j, uint seed_key) {
  const real3 first = row_of(sides, stride, HR_SIDE_CORNERS, j);
  const real3 corner = row_of(sides, stride, HR_SIDE_CENTER, j) + first;
  const real3 edge1 = row_of(sides, stride, HR_SIDE_CORNERS + 3, j) - first,
              edge2 = row_of(sides, stride, HR_SIDE_CORNERS + 6, j) - first;
  const real3 normal = row_of(sides, stride, HR_SIDE_NORMAL, j);
  for (int c = 0; c < 3; c++) {
    ((float*)t->corner[c])[lane] = pick(corner, c);
    ((float*)t->edge1[c])[lane] = pick(edge1, c);
    ((float*)t->edge2[c])[lane] = pick(edge2, c);
    ((float*)t->normal[c])[lane] = pick(normal, c);
  }
  const uint2 start = sequence_start(j, 2, seed_key);
  ((uint*)t->start_u)[lane] = start.x;
  ((uint*)t->start_v)[lane] = start.y;
}

// Points of the targets from `start`, what the pair exchanges there, and the start's height over the targets' planes.
static inline float16 aim_group(const Targets* t, uint group, uint sample, real3 start, real3 normal, float16* point,
                                float16* height) {
  const uint16 bits_u = t->start_u[group] + (sample + 1) * r4_steps[2],
               bits_v = t->start_v[group] + (sample + 1) * r4_steps[3];
  float16 u = unit16(bits_u), v = unit16(bits_v);
  const int16 above = v > u;
  const float16 half_u = 0.5f * u, half_v = 0.5f * v;
  u = select(u - half_v, half_u, above);
  v = select(half_v, v - half_u, above);
  const float origin[3] = {start.x, start.y, start.z};
  float16 d[3];
  for (uint c = 0; c < 3; c++) {
    point[c] = fma(t->edge2[c][group], v, fma(t->edge1[c][group], u, t->corner[c][group]));
    d[c] = point[c] - origin[c];
  }
  const float16 h = dot16((float16)(normal.x), (float16)(normal.y), (float16)(normal.z), d[0], d[1], d[2]);
  *height = -dot16(t->normal[0][group], t->normal[1][group], t->normal[2][group], d[0], d[1], d[2]);
  const float16 r2 = dot16(d[0], d[1], d[2], d[0], d[1], d[2]);
  return select((float16)(0.0f), h * *height / (r2 * r2), (h > 0.0f) & (*height > 0.0f));
}

// Rays `begin` to `end` of the pairs list[...]: exchanged[pair] += what they exchange, through[pair] += what of it gets
// through; shares[pair] = the quotient, errors[pair] = its standard error, were the points random. again[n] = 1 if pair
// list[n] is worth more: its rays disagree, and the error of a sequence, n^-3/4, still makes more than `accuracy` of
// the smaller side's factor. Launch: one item a packet of up to HR_AIMED pairs, list[firsts[p]] to list[firsts[p + 1]],
// all of row packet_rows[p].
kernel __attribute__((reqd_work_group_size(HR_LOCAL_SIZE, 1, 1))) void radiosity_sample_partial(
    HR_SCENE_PARAMETERS global const float* restrict sides, global const uint* restrict own_blockers,
    const uint stride, const float flatness, global const uint* restrict columns, global const uint* restrict list,
    global const uint* restrict packet_rows, global const uint* restrict firsts, const uint packet_count,
    const uint begin, const uint end, const float accuracy, const uint seed_key, global float* restrict exchanged,
    global float* restrict through, global float* restrict shares, global float* restrict errors,
    global uint* restrict again, const RenderParams params) {
  const uint packet = (uint)get_global_id(0);
  if (packet >= packet_count) return;
  HR_MAKE_SCENE_VIEW(params)
  const uint i = packet_rows[packet], first = firsts[packet], pairs = firsts[packet + 1] - first;
  const real3 corner = row_of(sides, stride, HR_SIDE_CORNERS, i);
  const real3 place = row_of(sides, stride, HR_SIDE_CENTER, i) + corner,
              edge1 = row_of(sides, stride, HR_SIDE_CORNERS + 3, i) - corner,
              edge2 = row_of(sides, stride, HR_SIDE_CORNERS + 6, i) - corner,
              normal = row_of(sides, stride, HR_SIDE_NORMAL, i);
  const uint2 start_bits = sequence_start(i, 0, seed_key);
  Targets targets;
  for (uint k = 0; k < HR_AIMED; k++) {
    put_target(&targets, k, sides, stride, columns[list[first + min(k, pairs - 1)]], seed_key);
  }
  float16 sum[HR_AIMED_GROUPS], passed[HR_AIMED_GROUPS];
  for (uint g = 0; g < HR_AIMED_GROUPS; g++) sum[g] = passed[g] = (float16)(0.0f);
  AimedRays aimed;
  for (uint sample = begin; sample < end; sample++) {
    const float2 w = onto_triangle(rng_unit(start_bits.x + (sample + 1) * r4_steps[0]),
                                   rng_unit(start_bits.y + (sample + 1) * r4_steps[1]));
    const real3 start = place + edge1 * w.x + edge2 * w.y;
    const real3 origin = offset_origin(start, (real3)((real)flatness), normal, normal);
    aim_from(&aimed, origin, normal, own_blockers[i]);
    float16 weights[HR_AIMED_GROUPS];
    bool any = false;
    for (uint g = 0; g < HR_AIMED_GROUPS && 16 * g < pairs; g++) {
      float16 point[3], height;
      weights[g] = aim_group(&targets, g, sample, start, normal, point, &height);
      const float *weight = (const float*)&weights[g], *x = (const float*)&point[0], *y = (const float*)&point[1],
                  *z = (const float*)&point[2], *over = (const float*)&height;
      for (uint k = 0; k < 16 && 16 * g + k < pairs; k++) {
        if (weight[k] == 0) continue;
        aim_at(&aimed, 16 * g + k, (real3)(x[k], y[k], z[k]), way_to(over[k], flatness));
        any = true;
      }
    }
    if (!any) continue;
    trace_aimed(&view, &aimed);
    for (uint k = 0; k < pairs; k++) {
      const float weight = ((const float*)weights)[k];
      ((float*)sum)[k] += weight;
      if (!is_blocked(&aimed, k)) ((float*)passed)[k] += weight;
    }
  }
  const float area = HR_SIDE_VALUE(HR_SIDE_AREA, i), rays = (float)end;
  for (uint k = 0; k < pairs; k++) {
    const uint pair = list[first + k];
    const float weight = exchanged[pair] + ((const float*)sum)[k], seen = through[pair] + ((const float*)passed)[k];
    const float share = weight > 0 ? seen / weight : 0.0f;
    exchanged[pair] = weight;
    through[pair] = seen;
    shares[pair] = share;
    errors[pair] = sqrt(share * (1 - share) / rays);
    const float factor = weight / rays * HR_INVERSE_PI * max(area, HR_SIDE_VALUE(HR_SIDE_AREA, columns[pair]));
    again[first + k] = errors[pair] * factor > accuracy * sqrt(sqrt(rays)) ? 1u : 0u;
  }
}
