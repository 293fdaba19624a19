// A packet against what is no triangle of the world: spheres, shapes, instances, planes.
#ifndef HR_LIB_PACKET_OTHERS_H
#define HR_LIB_PACKET_OTHERS_H

#include "lib/packet_hits.h"

#if HR_PACKETS

// Spheres and shapes of a block, ray by ray.
static inline void intersect_packet_others(const SceneView* view, Packet* p, global const float* block, bool* updated) {
  for (LaneSet rest = other_lanes(world_numbers(view), block); rest; rest = without_first(rest)) {
    const uint lane = first_lane(rest);
    for (uint k = 0; k < HR_K; k++) {
      float dx[16], dy[16], dz[16], t[16], part[16];
      int met[16];
      vstore16(p->dx[k], 0, dx);
      vstore16(p->dy[k], 0, dy);
      vstore16(p->dz[k], 0, dz);
      vstore16(p->t[k], 0, t);
      for (uint i = 0; i < 16; i++) {
        const Ray ray = make_ray(p->origin, (real3)(dx[i], dy[i], dz[i]), p->t_min, INFINITY);
        Hit hit;
        met[i] = intersect_lane(world_numbers(view), block, lane, &ray, t[i], &hit) ? -1 : 0;
        t[i] = met[i] ? hit.t : INFINITY;  // a miss leaves hit.t unset
        part[i] = met[i] ? hit.u : 0.0f;
      }
      if (take_hits(p, k, vload16(0, met), vload16(0, t), vload16(0, part), (float16)(0.0f),
                    (int)block_primitive(block, lane))) {
        *updated = true;
      }
    }
  }
}

// Which rays of group k can meet a box of the instance's object space.
static inline int16 rays_in_object_box(const Packet* p, uint k, global const Instance* i, real3 lo, real3 hi) {
  const real3 o = vector_to_object(i, p->origin - instance_place(i));
  const float4 row[3] = {i->to_object_x, i->to_object_y, i->to_object_z};
  float16 t_in = (float16)(p->t_min), t_out = p->t[k];
  for (int axis = 0; axis < 3; axis++) {
    const float16 rate = safe_reciprocal16(p->dx[k] * row[axis].x + p->dy[k] * row[axis].y + p->dz[k] * row[axis].z);
    const float16 t0 = (pick(lo, axis) - pick(o, axis)) * rate, t1 = (pick(hi, axis) - pick(o, axis)) * rate;
    t_in = max(t_in, min(t0, t1));
    t_out = min(t_out, max(t0, t1));
  }
  return t_in * HR_INTERVAL_NEAR <= t_out * HR_INTERVAL_FAR;
}

// Those rays that can meet the mesh's box go into the instance of a leaf one by one.
static inline void intersect_packet_instance(const SceneView* view, Packet* p, int leaf, bool* updated) {
  global const Instance* instance = view->instances + leaf_instance(leaf);
  global const float* root = node_at(view, view->tree_roots[instance->mesh + 1]);
  real3 lo = (real3)(INFINITY), hi = (real3)(-INFINITY);
  for (uint i = 0; i < HR_W; i++) {
    lo = min(lo, (real3)(root[i], root[2 * HR_W + i], root[4 * HR_W + i]));
    hi = max(hi, (real3)(root[HR_W + i], root[3 * HR_W + i], root[5 * HR_W + i]));
  }
  for (uint k = 0; k < HR_K; k++) {
    const int16 mask = rays_in_object_box(p, k, instance, lo, hi);
    if (!any_lane16(mask)) continue;
    const int* enters = (const int*)&mask;
    const float *dx = (const float*)&p->dx[k], *dy = (const float*)&p->dy[k], *dz = (const float*)&p->dz[k];
    float *t = (float*)&p->t[k], *u = (float*)&p->u[k], *v = (float*)&p->v[k];
    int* primitive = (int*)&p->primitive[k];
    for (uint i = 0; i < 16; i++) {
      if (!enters[i] || !(t[i] > p->t_min)) continue;
      const uint before = primitive[i] == -1 ? 0 : (uint)primitive[i];  // nothing counts at t_max itself
      Hit best = {t[i], u[i], v[i], before};
      const Ray ray = make_ray(p->origin, (real3)(dx[i], dy[i], dz[i]), p->t_min, t[i]);
      const Skip skip = {((const uint*)&p->skip[k])[i], 1, 0};
      walk_closest(view, &ray, &skip, leaf, -1, &best);
      if (best.t == t[i] && best.primitive == before) continue;
      t[i] = best.t;
      u[i] = best.u;
      v[i] = best.v;
      primitive[i] = (int)best.primitive;
      *updated = true;
    }
  }
}

// Planes, all rays at once.
static inline void intersect_packet_planes(const SceneView* view, Packet* p) {
  for (uint i = 0; i < view->plane_count; i++) {
    const Plane plane = view->planes[i];
    const real3 n = (real3)(plane.normal.x, plane.normal.y, plane.normal.z);
    const float height = dot3((real3)(plane.point.x, plane.point.y, plane.point.z) - p->origin, n);
    const int primitive = (int)(first_plane(view) + i);
    for (uint k = 0; k < HR_K; k++) {
      const float16 cosine = p->dx[k] * n.x + p->dy[k] * n.y + p->dz[k] * n.z;
      take_hits(p, k, cosine != 0.0f, height / cosine, (float16)(0.0f), (float16)(0.0f), primitive);
    }
  }
}

#endif

#endif
