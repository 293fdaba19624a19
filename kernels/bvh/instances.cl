// The tree over instances of meshes that have trees of their own: boxes in the world, and leaves that name an instance
// instead of blocks. In between it is built as any other tree.
#include "lib/accel_layout.h"
#include "lib/chunk.h"
#include "lib/instance.h"
#include "lib/tree_chunks.h"

static inline Box node_box(global const float* node) {
  Box box = {(float4)(INFINITY), (float4)(-INFINITY)};
  for (uint i = 0; i < HR_W; i++) {
    box.lo = min(box.lo, (float4)(node[i], node[2 * HR_W + i], node[4 * HR_W + i], 0.0f));
    box.hi = max(box.hi, (float4)(node[HR_W + i], node[3 * HR_W + i], node[5 * HR_W + i], 0.0f));
  }
  return box;
}

// mesh_boxes[mesh] = bounds of the tree below node `root`. Launch: 1 item.
kernel void bvh_bound_tree(HR_MORE_NODES(HR_CHUNK_READ) global const float* restrict accel_nodes, const uint root,
                           const uint mesh, global Box* restrict mesh_boxes) {
  SceneView view = {0};
  view.accel_nodes = accel_nodes;
  HR_MORE_NODES(HR_VIEW_CHUNK)
  mesh_boxes[mesh] = node_box(node_at(&view, root));
}

static inline float4 as_corner(real3 v) { return (float4)(v.x, v.y, v.z, 0.0f); }

// What a ray can meet of an instance, in the world: |L| h around L c + T, where c and h are middle and half size of the
// mesh's box. A ray is carried into the object with a few roundings, relative to its distance from the copy; seen from
// the world they move it by |L| |L^-1| times that. `reach` bounds the coordinates of the rays' ends.
static inline Box instance_box(global const Instance* instance, Box mesh, real3 reach) {
  const float4 middle = 0.5f * mesh.lo + 0.5f * mesh.hi, half_size = 0.5f * mesh.hi - 0.5f * mesh.lo;
  const real3 c = (real3)(middle.x, middle.y, middle.z), h = (real3)(half_size.x, half_size.y, half_size.z);
  const real3 place = instance_place(instance);
  const real3 center = vector_to_world(instance, c) + place;
  const real3 far = reach + fabs(place);
  const real3 moved = error_to_world(instance, error_to_object(instance, far));
  const real3 pad = (error_to_world(instance, fabs(c) + h) + fabs(place)) * HR_GAMMA(8) + moved * HR_GAMMA(8);
  const real3 size = error_to_world(instance, h) + pad;
  const Box box = {as_corner(center - size), as_corner(center + size)};
  return box;
}

// As bvh_bound_primitives, for instances; one of a mesh without primitives is left out and not counted. Launch: G
// items.
kernel void bvh_bound_instances(global const Instance* restrict instances, global const Box* restrict mesh_boxes,
                                const uint instance_count, const float4 reach, global Box* restrict boxes,
                                global BoundsPartial* restrict partials) {
  const uint g = (uint)get_global_id(0), groups = (uint)get_global_size(0);
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
  const uint end = chunk_begin(instance_count, g + 1, groups);
  for (uint i = chunk_begin(instance_count, g, groups); i < end; i++) {
    const Box mesh = mesh_boxes[instances[i].mesh];
    boxes[i] = empty;
    if (!(mesh.lo.x <= mesh.hi.x)) continue;
    const Box box = instance_box(instances + i, mesh, param3(reach));
    const float4 sum = box.lo + box.hi;
    if (!isfinite(sum.x + sum.y + sum.z)) {
      p.non_finite++;
      continue;
    }
    boxes[i] = box;
    const float4 centroid = 0.5f * box.lo + 0.5f * box.hi;
    p.valid++;
    p.lo = min(p.lo, box.lo);
    p.hi = max(p.hi, box.hi);
    p.centroid_lo = min(p.centroid_lo, centroid);
    p.centroid_hi = max(p.centroid_hi, centroid);
  }
  partials[g] = p;
}

// As bvh_refit_regions, for the tree of instances and their new boxes. Launch: one item a region.
kernel void bvh_refit_instances(global const Box* restrict boxes, global const CollapseRegion* restrict regions,
                                const uint first_region, const uint region_count,
                                HR_MORE_NODES(HR_CHUNK_WRITTEN) global float* accel_nodes) {
  const uint g = first_region + (uint)get_global_id(0);
  if (g >= region_count) return;
  const CollapseRegion region = regions[g];
  const NodeArrays nodes = {HR_NODE_ARRAYS};
  for (uint n = region.nodes; n-- > 0;) {
    global float* node = written_node(&nodes, region.final_node + n);
    for (uint i = 0; i < HR_W; i++) {
      const int child = ((global const int*)node)[HR_NODE_CHILD_ROW * HR_W + i];
      if (child == -1) continue;
      const Box box = child >= 0 ? node_box(written_node(&nodes, (uint)child)) : boxes[leaf_instance(child)];
      node[i] = box.lo.x;
      node[HR_W + i] = box.hi.x;
      node[2 * HR_W + i] = box.lo.y;
      node[3 * HR_W + i] = box.hi.y;
      node[4 * HR_W + i] = box.lo.z;
      node[5 * HR_W + i] = box.hi.z;
    }
  }
}
