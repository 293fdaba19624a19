// Traversal of the wide BVH, or of a tree of cells (HR_ACCEL), by a single ray. Planes are unbounded and are tested
// beside the tree. Primitive indices: triangles, spheres, shapes, planes, the triangles of all instances. Ties in t go
// to the smaller index.
#ifndef HR_LIB_TRAVERSE_H
#define HR_LIB_TRAVERSE_H

#include "lib/instance.h"
#include "lib/wide_node.h"
#if HR_ACCEL != HR_ACCEL_BVH
#include "lib/traverse_cells.h"
#endif

static inline bool intersect_plane_primitive(const SceneView* view, const Ray* ray, uint index, const Skip* skip,
                                             Hit* candidate) {
  const Plane plane = view->planes[index];
  candidate->primitive = first_plane(view) + index;
  if (is_skipped(skip, candidate->primitive)) return false;
  candidate->u = 0;
  candidate->v = 0;
  return intersect_plane(ray, (real3)(plane.point.x, plane.point.y, plane.point.z),
                         (real3)(plane.normal.x, plane.normal.y, plane.normal.z), &candidate->t);
}

#if HR_ACCEL == HR_ACCEL_BVH

// Where a ray is on its way: in the world's trees or in the shared tree of one instance.
typedef struct Walk {
  Ray ray;  // in that space; not kept where there are no instances
  Slabs slabs;
  BlockNumbers numbers;
  global const Instance* instance;  // null: in the world
  uint floor;                       // entries of the stack that wait outside
} Walk;

static inline Walk start_walk(const SceneView* view, const Ray* ray) {
  Walk walk;
  if (HR_HAS(INSTANCES)) walk.ray = *ray;
  walk.slabs = make_slabs(ray);
  walk.numbers = world_numbers(view);
  walk.instance = 0;
  walk.floor = 0;
  return walk;
}

static inline const Ray* walked_ray(const Walk* walk, const Ray* world_ray) {
  return HR_HAS(INSTANCES) ? &walk->ray : world_ray;
}

// Goes into the instance of a leaf and returns the root of its tree.
static inline int enter_instance(const SceneView* view, const Ray* world_ray, int leaf, uint stack_size, Walk* walk) {
  walk->instance = view->instances + leaf_instance(leaf);
  walk->ray = ray_to_object(walk->instance, world_ray);
  walk->slabs = make_slabs(&walk->ray);
  walk->numbers.first = walk->instance->first_id;
  walk->numbers.triangles = 0x7fffffffu;  // there is nothing else
  walk->floor = stack_size;
  return view->tree_roots[walk->instance->mesh + 1];
}

// Finds the closest hit below node or leaf `at`, and then below `later` where that is one (>= 0); *best holds the
// closest so far, beyond which nothing counts.
static inline void walk_closest(const SceneView* view, const Ray* world_ray, const Skip* skip, int at, int later,
                                Hit* best) {
  Walk walk = start_walk(view, world_ray);
  const Ray* ray = walked_ray(&walk, world_ray);
  StackEntry stack[HR_TRAVERSAL_STACK];
  uint size = 0;
  if (HR_HAS(INSTANCES) && later >= 0) stack[size++] = HR_ENTRY(0.0f, later);
  for (;;) {
    if (at >= 0) {
      HR_VISIT_NODE(view);
      global const float* node = node_at(view, at);
      float t_near[HR_W] HR_ALIGN_AS_VECTOR(HR_W);
      const LaneSet lanes = enter_children(node, ray->t_min, &walk.slabs, best->t, t_near);
      if (lanes) {
        at = nearest_child(view, node, lanes, t_near, stack, &size);
        continue;
      }
    } else if (HR_HAS(INSTANCES) && is_instance_leaf(at)) {
      at = enter_instance(view, world_ray, at, size, &walk);
      continue;
    } else {
      const uint leaf = (uint)~at;
      global const float* block = block_at(view, leaf >> 4);
      for (uint n = leaf & 15u; n > 0; n--, block += HR_BLOCK_ROWS * HR_L) {
        HR_VISIT_BLOCK(view);
        intersect_block_closest(walk.numbers, block, ray, skip, best);
      }
    }
    StackEntry entry = 0;
    bool found = false;
    while (!found) {
      if (HR_HAS(INSTANCES) && walk.instance && size == walk.floor) {
        const bool hit = best->primitive - walk.instance->first_id < walk.instance->triangle_count;
        if (hit && (walk.instance->flags & HR_INSTANCE_MIRRORED)) {
          const real u = best->u;
          best->u = best->v;
          best->v = u;
        }
        walk = start_walk(view, world_ray);
      }
      if (size == 0) return;
      entry = stack[--size];
      found = as_float((uint)(entry >> 32)) <= best->t * HR_SLAB_PAD;
    }
    at = (int)(uint)entry;
  }
}

// Is there any hit in (t_min, t_max) below node `at`, or below `later` where that is one (>= 0)?
static inline bool walk_any(const SceneView* view, const Ray* world_ray, const Skip* skip, int at, int later) {
  Walk walk = start_walk(view, world_ray);
  const Ray* ray = walked_ray(&walk, world_ray);
  int stack[HR_TRAVERSAL_STACK];
  uint size = 0;
  if (HR_HAS(INSTANCES) && later >= 0) stack[size++] = later;
  for (;;) {
    if (at >= 0) {
      HR_VISIT_NODE(view);
      global const float* node = node_at(view, at);
      float t_near[HR_W] HR_ALIGN_AS_VECTOR(HR_W);
      LaneSet lanes = enter_children(node, ray->t_min, &walk.slabs, world_ray->t_max, t_near);
      if (lanes) {
        // The last one goes first (bvh/cut.h, order_children).
        global const int* child = node_children(node);
        at = child[first_lane(lanes)];
        for (lanes = without_first(lanes); lanes; lanes = without_first(lanes)) {
          stack[size++] = at;
          at = child[first_lane(lanes)];
        }
        continue;
      }
    } else if (HR_HAS(INSTANCES) && is_instance_leaf(at)) {
      at = enter_instance(view, world_ray, at, size, &walk);
      continue;
    } else {
      const uint leaf = (uint)~at;
      global const float* block = block_at(view, leaf >> 4);
      for (uint n = leaf & 15u; n > 0; n--, block += HR_BLOCK_ROWS * HR_L) {
        HR_VISIT_BLOCK(view);
        if (intersect_block_any(walk.numbers, block, ray, skip)) return true;
      }
    }
    if (HR_HAS(INSTANCES) && walk.instance && size == walk.floor) walk = start_walk(view, world_ray);
    if (size == 0) return false;
    at = stack[--size];
  }
}

// The root of the tree of instances, or no node.
static inline int instance_root(const SceneView* view) { return HR_HAS(INSTANCES) ? view->tree_roots[0] : -1; }

#endif

// Closest hit in (t_min, t_max), or primitive = HR_NO_PRIMITIVE and t = t_max.
static inline Hit traverse_closest(const SceneView* view, const Ray* ray, const Skip* skip) {
  Hit best;
  best.t = ray->t_max;
  best.u = 0;
  best.v = 0;
  best.primitive = 0;  // a hit at t_max itself is not one: no index is smaller
  if (HR_HAS(PLANES)) {
    for (uint i = 0; i < view->plane_count; i++) {
      Hit candidate;
      if (intersect_plane_primitive(view, ray, i, skip, &candidate) && is_closer(&candidate, &best)) best = candidate;
    }
  }
#if HR_ACCEL != HR_ACCEL_BVH
  traverse_cells_closest(view, ray, skip, &best);
#else
  walk_closest(view, ray, skip, 0, instance_root(view), &best);
#endif
  if (best.t == ray->t_max) best.primitive = HR_NO_PRIMITIVE;
  return best;
}

// Is there any hit in (t_min, t_max)?
static inline bool traverse_any(const SceneView* view, const Ray* ray, const Skip* skip) {
  if (HR_HAS(PLANES)) {
    for (uint i = 0; i < view->plane_count; i++) {
      Hit candidate;
      if (intersect_plane_primitive(view, ray, i, skip, &candidate) && candidate.t < ray->t_max) return true;
    }
  }
#if HR_ACCEL != HR_ACCEL_BVH
  return traverse_cells_any(view, ray, skip);
#else
  return walk_any(view, ray, skip, 0, instance_root(view));
#endif
}

#endif
