// Progressive radiosity (Southwell; Cohen, Chen, Wallace, Greenberg 1988, "A Progressive Refinement Approach to Fast
// Radiosity Image Generation"): the sides with the most unshot light send it to all others. A row is all a shot needs:
// its column follows by reciprocity, F_ki = F_ik A_i / A_k.
#include "lib/chunk.h"
#include "radiosity/factors.h"
#include "radiosity/row_search.h"
#include "radiosity/wide_sum.h"
#include "shared/radiosity_types.h"

// best_sides and best_scores [g shots, (g + 1) shots): those of chunk g with most unshot light, most first, smaller
// sides first among equals, HR_NO_SIDE where it has none. The score is |e| . of_column, times the area if by_power.
// Launch: G items.
kernel void radiosity_pick(global const wide4* restrict unshot, global const float4* restrict normals, const uint count,
                           const uint shots, const float4 of_column, const uint by_power,
                           global uint* restrict best_sides, global float* restrict best_scores) {
  const uint g = (uint)get_global_id(0), groups = (uint)get_global_size(0);
  global uint* sides = best_sides + g * shots;
  global float* scores = best_scores + g * shots;
  for (uint i = 0; i < shots; i++) {
    sides[i] = HR_NO_SIDE;
    scores[i] = 0;
  }
  const uint end = chunk_begin(count, g + 1, groups);
  for (uint s = chunk_begin(count, g, groups); s < end; s++) {
    const real4 e = fabs(wide_value(unshot[s])) * real4_of(of_column);
    const float score = (float)(e.x + e.y + e.z + e.w) * (by_power ? normals[s / 2].w : 1.0f);
    if (!(score > scores[shots - 1])) continue;
    uint at = shots - 1;
    for (; at > 0 && score > scores[at - 1]; at--) {
      scores[at] = scores[at - 1];
      sides[at] = sides[at - 1];
    }
    scores[at] = score;
    sides[at] = s;
  }
}

// Shot n, from side rows[picks[n]]: shot[n] = e / (1 - rho F_ii), what the side sends, its own light on itself summed
// up; B += shot; and e keeps what rounding leaves of it, nothing in exact arithmetic. Launch: count items.
kernel void radiosity_take_unshot(global const uint* restrict rows, global const uint* restrict starts,
                                  global const uint* restrict columns, HR_FACTORS(values),
                                  global const uint* restrict picks, const uint count,
                                  global const float4* restrict reflectance, global wide4* restrict unshot,
                                  global wide4* restrict radiosity, global real4* restrict shot) {
  const uint n = (uint)get_global_id(0);
  if (n >= count) return;
  const uint k = picks[n], side = rows[k];
  const uint entry = first_entry(columns, starts[k], starts[k + 1], side);
  const real own = entry < starts[k + 1] && columns[entry] == side ? (real)HR_FACTOR(values, k, entry) : (real)0;
  const real4 kept = (real4)(1) - real4_of(reflectance[side]) * (real4)(own);
  const real4 sent = wide_value(unshot[side]) / kept;
  shot[n] = sent;
  radiosity[side] = wide_add_product(radiosity[side], sent, (real4)(1));
  unshot[side] = wide_add_product(unshot[side], sent, -kept);
}

// The shots of radiosity_take_unshot arrive: incident += H, e += rho H on a side and tau H on the other one of its
// triangle. A side that light reaches for the first time has w's source 1 added: sides that none reaches need no bound.
// The sides are dealt out to the items, which go through the rows in order, so that sums have one order. Launch: G
// items.
kernel void radiosity_spread(global const uint* restrict rows, global const uint* restrict starts,
                             global const uint* restrict columns, HR_FACTORS(values), global const uint* restrict picks,
                             const uint count, global const real4* restrict shot, global const float4* restrict normals,
                             const uint patch_count, global const float4* restrict reflectance,
                             global const float4* restrict transmittance, global wide4* restrict unshot,
                             global real4* restrict incident, global uint* restrict reached) {
  const uint g = (uint)get_global_id(0), groups = (uint)get_global_size(0);
  const uint begin = 2 * chunk_begin(patch_count, g, groups), end = 2 * chunk_begin(patch_count, g + 1, groups);
  for (uint n = 0; n < count; n++) {
    const uint k = picks[n], side = rows[k];
    const real area = (real)normals[side / 2].w;
    const real4 sent = shot[n];
    for (uint i = first_entry(columns, starts[k], starts[k + 1], begin); i < starts[k + 1] && columns[i] < end; i++) {
      const uint to = columns[i];
      const real4 arrives = sent * (real4)((real)HR_FACTOR(values, k, i) * (area / (real)normals[to / 2].w));
      incident[to] += arrives;
      // What the side sends to itself is in `sent` already.
      if (to != side) unshot[to] = wide_add_product(unshot[to], arrives, real4_of(reflectance[to]));
      const float4 tau = transmittance[to ^ 1u];
      const bool passes = tau.w > 0;
      if (passes) unshot[to ^ 1u] = wide_add_product(unshot[to ^ 1u], arrives, real4_of(tau));
      for (uint other = 0; other < (passes ? 2u : 1u); other++) {
        if (reached[to ^ other]) continue;
        reached[to ^ other] = 1;
        unshot[to ^ other] = wide_add_product(unshot[to ^ other], (real4)(0, 0, 0, 1), (real4)(1));
      }
    }
  }
}
