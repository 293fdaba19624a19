// The film: sums of radiance per pixel, one sample a pixel and launch, so that every sum has one order.
#include "lib/vec.h"
#include "shared/features.h"

#ifndef HR_LOCAL_SIZE
#define HR_LOCAL_SIZE 64
#endif

// Adds the sums of slot i to pixel first_pixel + i. Launch: one item a slot in [0, count).
kernel __attribute__((reqd_work_group_size(HR_LOCAL_SIZE, 1, 1))) void film_accumulate(
    global const float4* restrict path_sum_direct,
    HR_IF_REFLECTION(global const float4* restrict path_sum_reflection HR_COMMA)
        HR_IF_REFRACTION(global const float4* restrict path_sum_refraction HR_COMMA)
            global float4* restrict film_direct,
    HR_IF_REFLECTION(global float4* restrict film_reflection HR_COMMA)
        HR_IF_REFRACTION(global float4* restrict film_refraction HR_COMMA) const uint first_pixel,
    const uint count) {
  const uint slot = (uint)get_global_id(0);
  if (slot >= count) return;
  const uint pixel = first_pixel + slot;
  film_direct[pixel] += path_sum_direct[slot];
  HR_IF_REFLECTION(film_reflection[pixel] += path_sum_reflection[slot];)
  HR_IF_REFRACTION(film_refraction[pixel] += path_sum_refraction[slot];)
}
