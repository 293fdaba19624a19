// The share of a partly hidden pair's exchange that gets through: rays between points of both, weighted by what is
// exchanged between them, tested against what the pair's shaft holds. Points follow a sequence that fills all four
// dimensions evenly (Roberts 2018, R_4), two for the row's side and two for the column's.
#include "lib/offset.h"
#include "lib/rng.h"
#include "radiosity/aimed_rays.h"
#include "radiosity/pair_sides.h"
#include "radiosity/row_search.h"
#include "radiosity/shaft.h"

#define HR_DIMENSION_PARTIAL 104u
#define HR_INVERSE_PI 0.318309886f
// What n rays of a sequence are off by falls with n to this power: 1/2 + 1/8 where a surface of four dimensions is hit
// or missed (Owen's and Wang's smooth case lies higher; 0.66 was measured).
#define HR_PARTIAL_ORDER 0.66f

// Powers of 1 / phi, phi^5 = phi + 1, in units of 2^-32.
constant uint r4_steps[4] = {3679390609u, 3152041523u, 2700274806u, 2313257605u};

// Points of a triangle for numbers in [0, 1)^2, a square folded with little distortion (Heitz 2019).
static inline void points_on(const float3* corners, uint2 start, uint step, uintp numbers, floatp* points) {
  const floatp u = floats_of((start.x + numbers * r4_steps[step]) >> 8) * 5.9604644775390625e-8f,
               v = floats_of((start.y + numbers * r4_steps[step + 1]) >> 8) * 5.9604644775390625e-8f;
  const intp above = v > u;
  const floatp half_u = 0.5f * u, half_v = 0.5f * v;
  const floatp second = choose(u - half_v, half_u, above), third = choose(half_v, v - half_u, above);
  for (int c = 0; c < 3; c++) {
    const float at = pick(corners[0], c);
    points[c] = fma(third, (floatp)(pick(corners[2], c) - at), fma(second, (floatp)(pick(corners[1], c) - at), at));
  }
}

static inline float3 side_value3(global const float* sides, uint stride, uint row, uint i) {
  return (float3)(HR_SIDE_VALUE(row, i), HR_SIDE_VALUE(row + 1, i), HR_SIDE_VALUE(row + 2, i));
}

// A side's corners from a shaft's origin, and its plane moved to its front by what rounding may do at a `distance`.
static inline float4 put_side(Shaft* shaft, uint at, global const float* sides, uint stride, uint i, float distance) {
  const float3 center = side_value3(sides, stride, HR_SIDE_CENTER, i) - shaft->origin,
               normal = side_value3(sides, stride, HR_SIDE_NORMAL, i);
  for (uint k = 0; k < 3; k++) {
    shaft->corners[at + k] = center + side_value3(sides, stride, HR_SIDE_CORNERS + 3 * k, i);
  }
  const float slack = shaft->flatness + HR_SIDE_VALUE(HR_SIDE_SLOPE, i) * distance;
  return (float4)(normal, -dot3(normal, center) - slack);
}

// For a shaft that holds more than its list does: ray by ray through the tree.
static intp blocked_in_scene(const SceneView* view, const Shaft* shaft, float3 normal, uint own, uint other,
                             const floatp* from, const floatp* to, const floatp* heights) {
  intp blocked = (intp)(0);
  for (uint k = 0; k < HR_P; k++) {
    const float3 x = (float3)(((const float*)&from[0])[k], ((const float*)&from[1])[k], ((const float*)&from[2])[k]),
                 y = (float3)(((const float*)&to[0])[k], ((const float*)&to[1])[k], ((const float*)&to[2])[k]);
    const real3 start = x + shaft->origin, out = normal;
    const real3 origin = offset_origin(start, (real3)((real)shaft->flatness), out, out);
    const Ray ray =
        make_ray(origin, y + shaft->origin - origin, 0, way_to(((const float*)heights)[k], shaft->flatness));
    const Skip skip = {own, other, other};
    ((int*)&blocked)[k] = traverse_any(view, &ray, &skip) ? -1 : 0;
  }
  return blocked;
}

// shares[pair] = what of the exchange of pair `pair` of the list (starts, columns) gets through; errors[pair] = its
// standard error, were the points random; rays[item] = those traced. A pair gets `few` rays, and up to `many` in steps
// of four times as many while the next would bring both sides' rows closer by `accuracy` each. Launch: an item a pair,
// from `first` to `end`.
kernel __attribute__((reqd_work_group_size(HR_LOCAL_SIZE, 1, 1))) void radiosity_sample_partial(
    HR_SCENE_PARAMETERS global const float* restrict sides, global const uint* restrict own_blockers, const uint stride,
    const uint count, const float flatness, global const uint* restrict starts, global const uint* restrict columns,
    const uint first, const uint end, const uint few, const uint many, const float accuracy, const uint seed_key,
    global float* restrict shares, global float* restrict errors, global uint* restrict rays,
    const RenderParams params) {
  const uint pair = first + (uint)get_global_id(0);
  if (pair >= end) return;
  HR_MAKE_SCENE_VIEW(params)
  const uint i = first_entry(starts, 0, count + 1, pair + 1) - 1, j = columns[pair];
  const float3 away = side_value3(sides, stride, HR_SIDE_CENTER, j) - side_value3(sides, stride, HR_SIDE_CENTER, i);
  const float distance = sqrt(dot3(away, away));
  Shaft shaft;
  shaft.origin = side_value3(sides, stride, HR_SIDE_CENTER, i);
  shaft.flatness = flatness;
  const float4 front_i = put_side(&shaft, 0, sides, stride, i, distance),
               front_j = put_side(&shaft, 3, sides, stride, j, distance);
  make_shaft(&shaft, front_i, front_j);
  Blocker blockers[HR_SHAFT_BLOCKERS];
  const uint blocker_count = find_blockers(&view, &shaft, own_blockers[i], own_blockers[j], blockers);
  float share = 1, error = 0;
  uint n = 0;
  if (blocker_count > 0) {
    // Where the pair's sequence starts, in units of 2^-32: a place of its own, so that variances of pairs add.
    const uint4 start = rng_hash((uint4)(i, j, 0, HR_DIMENSION_PARTIAL ^ seed_key));
    const float areas = HR_SIDE_VALUE(HR_SIDE_AREA, i) + HR_SIDE_VALUE(HR_SIDE_AREA, j);
    float exchanged = 0, through = 0;
    uint target = few;
    for (;;) {
      floatp sum = (floatp)(0.0f), passed = sum;
      for (; n < target; n += HR_P) {
        const uintp numbers = n + 1 + HR_LANE_NUMBERS;
        floatp from[3], to[3];
        points_on(shaft.corners, start.xy, 0, numbers, from);
        points_on(shaft.corners + 3, start.zw, 2, numbers, to);
        const floatp dx = to[0] - from[0], dy = to[1] - from[1], dz = to[2] - from[2];
        const floatp h = dot_lanes((floatp)(front_i.x), (floatp)(front_i.y), (floatp)(front_i.z), dx, dy, dz);
        const floatp g = -dot_lanes((floatp)(front_j.x), (floatp)(front_j.y), (floatp)(front_j.z), dx, dy, dz);
        const floatp r2 = dot_lanes(dx, dy, dz, dx, dy, dz);
        const floatp weight = choose((floatp)(0.0f), h * g / (r2 * r2), (h > 0.0f) & (g > 0.0f));
        sum += weight;
        intp open = weight > 0.0f;
        if (blocker_count > HR_SHAFT_BLOCKERS) {
          open &=
              no_lanes(blocked_in_scene(&view, &shaft, front_i.xyz, own_blockers[i], own_blockers[j], from, to, &g));
        } else {
          for (uint k = 0; k < blocker_count && any_lane(open); k++)
            open &= no_lanes(blocked_by(&blockers[k], from, to));
        }
        passed += choose((floatp)(0.0f), weight, open);
      }
      exchanged += sum_lanes(sum);
      through += sum_lanes(passed);
      if (!(exchanged > 0)) {
        share = 0;
        break;
      }
      share = min(through / exchanged, 1.0f);
      const float number = (float)n, factors = exchanged / number * HR_INVERSE_PI * areas;
      error = sqrt(share * (1 - share) / number);
      const float likely = (share * number + 0.5f) / (number + 1);  // rays that agree do not prove much
      if (n >= many || factors * sqrt(likely * (1 - likely)) <= accuracy * pow(number, 1 + HR_PARTIAL_ORDER)) break;
      target = min(4 * n, many);
    }
  }
  shares[pair] = share;
  errors[pair] = error;
  rays[pair - first] = n;
}
