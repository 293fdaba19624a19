// First steps of the tree: boxes and the scene's bounds, then each primitive's place along the Z-order curve
// (Karras 2012, "Maximizing Parallelism in the Construction of BVHs, Octrees, and k-d Trees").
#include "lib/chunk.h"
#include "lib/primitive.h"

// boxes[i] = bounds of primitive i (empty if it is dropped); partials[g] = bounds of the valid primitives of chunk g
// and how many are valid or dropped. Launch: G items.
kernel void bvh_bound_primitives(HR_GEOMETRY_PARAMETERS const uint first_triangle, const uint primitive_count,
                                 global Box* restrict boxes, global BoundsPartial* restrict partials) {
  const uint g = (uint)get_global_id(0), groups = (uint)get_global_size(0);
  HR_MAKE_GEOMETRY(first_triangle)
  const Box empty = {(float4)(INFINITY), (float4)(-INFINITY)};
  BoundsPartial p;
  p.lo = empty.lo;
  p.hi = empty.hi;
  p.centroid_lo = p.lo;
  p.centroid_hi = p.hi;
  p.valid = 0;
  p.non_finite = 0;
  p.degenerate = 0;
  p.pad = 0;
  const uint end = chunk_begin(primitive_count, g + 1, groups);
  for (uint i = chunk_begin(primitive_count, g, groups); i < end; i++) {
    const Primitive primitive = load_primitive(&geometry, i);
    const Box box = primitive_box(primitive);
    const uint status = primitive_status(primitive, box);
    p.valid += status == HR_PRIMITIVE_VALID;
    p.non_finite += status == HR_PRIMITIVE_NON_FINITE;
    p.degenerate += status == HR_PRIMITIVE_DEGENERATE;
    if (status != HR_PRIMITIVE_VALID) {
      boxes[i] = empty;
      continue;
    }
    boxes[i] = box;
    const float4 centroid = 0.5f * box.lo + 0.5f * box.hi;
    p.lo = min(p.lo, box.lo);
    p.hi = max(p.hi, box.hi);
    p.centroid_lo = min(p.centroid_lo, centroid);
    p.centroid_hi = max(p.centroid_hi, centroid);
  }
  partials[g] = p;
}

// Spreads the low 21 bits of x, two zeros after each.
static inline ulong spread_bits(uint x) {
  ulong v = x & 0x1fffffu;
  v = (v | v << 32) & 0x001f00000000fffful;
  v = (v | v << 16) & 0x001f0000ff0000fful;
  v = (v | v << 8) & 0x100f00f00f00f00ful;
  v = (v | v << 4) & 0x10c30c30c30c30c3ul;
  return (v | v << 2) & 0x1249249249249249ul;
}

// keys[i] = Morton code of primitive i's box centre with `axis_bits` bits an axis, x highest, above i itself in the low
// `index_bits`: keys differ, and sorting them moves one array. A dropped primitive has the code 1 << 3 axis_bits,
// beyond all others. scale = cells an axis / extent, 0 for an axis without extent. Launch: G items.
kernel void bvh_code_primitives(global const Box* restrict boxes, const uint primitive_count, const float4 centroid_lo,
                                const float4 scale, const uint axis_bits, const uint index_bits,
                                global ulong* restrict keys) {
#pragma OPENCL FP_CONTRACT OFF
  const uint g = (uint)get_global_id(0), groups = (uint)get_global_size(0);
  const float4 last = (float4)((float)((1u << axis_bits) - 1));
  const uint end = chunk_begin(primitive_count, g + 1, groups);
  for (uint i = chunk_begin(primitive_count, g, groups); i < end; i++) {
    const Box box = boxes[i];
    if (!(box.lo.x <= box.hi.x)) {
      keys[i] = (1ul << (3 * axis_bits)) << index_bits | i;
      continue;
    }
    // min and max with the limit first: what is not a number becomes the limit.
    const float4 cell = max((float4)(0.0f), min(last, (0.5f * box.lo + 0.5f * box.hi - centroid_lo) * scale));
    const ulong code = spread_bits((uint)cell.x) << 2 | spread_bits((uint)cell.y) << 1 | spread_bits((uint)cell.z);
    keys[i] = code << index_bits | i;
  }
}
