// First steps of the tree: the scene's bounds, then each primitive's place along the Z-order curve
// (Karras 2012, "Maximizing Parallelism in the Construction of BVHs, Octrees, and k-d Trees").
#include "lib/primitive.h"

static inline uint bvh_chunk_begin(uint n, uint g, uint groups) { return (uint)((ulong)n * g / groups); }

#define HR_GEOMETRY_PARAMETERS                                                    \
  global const float *restrict positions, global const uint4 *restrict triangles, \
      global const Sphere *restrict spheres, const uint triangle_count, const uint primitive_count

// partials[g] = bounds of the valid primitives of chunk g and how many are valid or dropped. Launch: G items.
kernel void bvh_bound_primitives(HR_GEOMETRY_PARAMETERS, global BoundsPartial* restrict partials) {
  const uint g = (uint)get_global_id(0), groups = (uint)get_global_size(0);
  BoundsPartial p;
  p.lo = (float4)(INFINITY);
  p.hi = (float4)(-INFINITY);
  p.centroid_lo = p.lo;
  p.centroid_hi = p.hi;
  p.valid = 0;
  p.non_finite = 0;
  p.degenerate = 0;
  p.pad = 0;
  const uint end = bvh_chunk_begin(primitive_count, g + 1, groups);
  for (uint i = bvh_chunk_begin(primitive_count, g, groups); i < end; i++) {
    const BvhLeaf leaf = load_primitive(positions, triangles, spheres, triangle_count, i);
    const uint status = primitive_status(leaf, i < triangle_count);
    p.valid += status == HR_PRIMITIVE_VALID;
    p.non_finite += status == HR_PRIMITIVE_NON_FINITE;
    p.degenerate += status == HR_PRIMITIVE_DEGENERATE;
    if (status != HR_PRIMITIVE_VALID) continue;
    const Box box = primitive_box(leaf, i < triangle_count);
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

// keys[i] = Morton code of primitive i's box centre with `axis_bits` (10 or 21) bits an axis, x highest; a dropped
// primitive gets 1 << 3 axis_bits, beyond every code, and so sorts to the end. values[i] = i. Launch: G items.
kernel void bvh_code_primitives(HR_GEOMETRY_PARAMETERS, const float4 centroid_lo, const float4 centroid_hi,
                                const uint axis_bits, global ulong* restrict keys, global uint* restrict values) {
  const uint g = (uint)get_global_id(0), groups = (uint)get_global_size(0);
  const float cells = (float)(1u << axis_bits);
  const float4 extent = centroid_hi - centroid_lo;
  const uint last = (1u << axis_bits) - 1;
  const uint end = bvh_chunk_begin(primitive_count, g + 1, groups);
  for (uint i = bvh_chunk_begin(primitive_count, g, groups); i < end; i++) {
    const BvhLeaf leaf = load_primitive(positions, triangles, spheres, triangle_count, i);
    values[i] = i;
    if (primitive_status(leaf, i < triangle_count) != HR_PRIMITIVE_VALID) {
      keys[i] = 1ul << (3 * axis_bits);
      continue;
    }
    const Box box = primitive_box(leaf, i < triangle_count);
    const float4 relative = (0.5f * box.lo + 0.5f * box.hi) - centroid_lo;
    const uint x = extent.x > 0 ? min((uint)(relative.x / extent.x * cells), last) : 0;
    const uint y = extent.y > 0 ? min((uint)(relative.y / extent.y * cells), last) : 0;
    const uint z = extent.z > 0 ? min((uint)(relative.z / extent.z * cells), last) : 0;
    keys[i] = spread_bits(x) << 2 | spread_bits(y) << 1 | spread_bits(z);
  }
}
