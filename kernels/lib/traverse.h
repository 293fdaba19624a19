// Traversal of the binary BVH by a single ray. Planes are unbounded and are tested beside the tree.
// Primitive indices: triangles, then spheres, then planes. Ties in t go to the smaller index.
#ifndef HR_LIB_TRAVERSE_H
#define HR_LIB_TRAVERSE_H

#include "lib/intersect.h"
#include "lib/scene_view.h"

// One entry a level: 64 bits of Morton code and 32 of the index that tells equal codes apart.
#define HR_BVH_STACK_SIZE 96

// Primitives a ray must not meet: the one it left, and those of the light it is traced to (inclusive range, which is
// empty if skip_first > skip_last).
typedef struct Skip {
  uint self;
  uint first, last;
} Skip;

static inline bool is_skipped(const Skip* skip, uint primitive) {
  return primitive == skip->self || (primitive >= skip->first && primitive <= skip->last);
}

static inline bool intersect_leaf(const SceneView* view, const Ray* ray, uint index, const Skip* skip, Hit* candidate) {
  const BvhLeaf leaf = view->bvh_leaves[index];
  candidate->primitive = as_uint(leaf.a.w);
  if (is_skipped(skip, candidate->primitive)) return false;
  candidate->u = 0;
  candidate->v = 0;
  const real3 a = (real3)(leaf.a.x, leaf.a.y, leaf.a.z);
  if (HR_HAS(SPHERES) && candidate->primitive >= view->triangle_count) {
    return intersect_sphere(ray, a, leaf.b.x, &candidate->t);
  }
  if (!HR_HAS(TRIANGLES)) return false;
  const real3 b = (real3)(leaf.b.x, leaf.b.y, leaf.b.z);
  const real3 c = (real3)(leaf.c.x, leaf.c.y, leaf.c.z);
  return intersect_triangle(ray, a, b, c, &candidate->t, &candidate->u, &candidate->v);
}

static inline bool intersect_plane_primitive(const SceneView* view, const Ray* ray, uint index, const Skip* skip,
                                             Hit* candidate) {
  const Plane plane = view->planes[index];
  candidate->primitive = view->triangle_count + view->sphere_count + index;
  if (is_skipped(skip, candidate->primitive)) return false;
  candidate->u = 0;
  candidate->v = 0;
  return intersect_plane(ray, (real3)(plane.point.x, plane.point.y, plane.point.z),
                         (real3)(plane.normal.x, plane.normal.y, plane.normal.z), &candidate->t);
}

static inline bool is_closer(const Hit* candidate, const Hit* best) {
  return candidate->t < best->t || (candidate->t == best->t && candidate->primitive < best->primitive);
}

// Closest hit in (t_min, t_max), or primitive = HR_NO_PRIMITIVE and t = t_max. With any = true the first one found.
static inline Hit traverse(const SceneView* view, const Ray* ray, const Skip* skip, bool any) {
  Hit best;
  best.t = ray->t_max;
  best.u = 0;
  best.v = 0;
  best.primitive = 0;  // a hit at t_max itself is not one: no index is smaller
  bool found = false;
  Hit candidate;
  if (HR_HAS(PLANES)) {
    for (uint i = 0; i < view->plane_count; i++) {
      if (intersect_plane_primitive(view, ray, i, skip, &candidate) && is_closer(&candidate, &best)) {
        best = candidate;
        found = true;
      }
    }
  }
  int stack[HR_BVH_STACK_SIZE];
  int stack_size = 0;
  int node_index = 0;
  while (node_index >= 0 && !(any && found)) {
    const BvhNode node = view->bvh_nodes[node_index];
    const int child[2] = {(int)node.child.x, (int)node.child.y};
    real2 t_near;
    const int2 entered = intersect_boxes(ray, &node, best.t, &t_near);
    bool enter[2] = {entered.x != 0, entered.y != 0};
    for (int side = 0; side < 2; side++) {
      if (enter[side] && child[side] < 0) {
        if (intersect_leaf(view, ray, (uint)~child[side], skip, &candidate) && is_closer(&candidate, &best)) {
          best = candidate;
          found = true;
        }
        enter[side] = false;
      }
    }
    if (enter[0] && enter[1]) {
      const int far_side = t_near.x <= t_near.y ? 1 : 0;
      stack[stack_size++] = child[far_side];
      node_index = child[1 - far_side];
    } else if (enter[0] || enter[1]) {
      node_index = enter[0] ? child[0] : child[1];
    } else {
      node_index = stack_size > 0 ? stack[--stack_size] : -1;
    }
  }
  if (!found) best.primitive = HR_NO_PRIMITIVE;
  return best;
}

#endif
