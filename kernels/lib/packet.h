// Packets (lib/packet_rays.h) of camera rays, of rays from a point light or of a hemicube go through the tree together.
// A node's children are first tested against the interval of all directions, then each survivor against the rays
// themselves (Wald, Boulos, Shirley 2007, "Ray Tracing Deformable Scenes Using Dynamic BVHs", with exact second test).
#ifndef HR_LIB_PACKET_H
#define HR_LIB_PACKET_H

#include "lib/edge_function.h"
#include "lib/packet_rays.h"
#include "lib/traverse.h"

// Blocks of one lane have no vectors to test: RayQueries traces their rays one by one.
#define HR_PACKETS (HR_EXPLICIT_VECTORS && HR_W > 1 && HR_L > 1)
#if HR_PACKETS

// The bounds of a whole packet are widened by 8 ulps on both sides: a reciprocal, a difference and a product of error.
#define HR_INTERVAL_NEAR 0.999999f
#define HR_INTERVAL_FAR 1.000001f
// Directions nearer to zero than this count as both signs.
#define HR_MIXED_DIRECTION 1e-12f

// The slabs of one axis for all directions in [lo, hi].
typedef struct AxisInterval {
  uint near_row, far_row;                      // in words
  float near_rate, far_rate, other_near_rate;  // 1 / direction
  bool mixed;                                  // both signs: rays may enter by either plane and need not leave
} AxisInterval;

static inline AxisInterval make_axis_interval(float lo, float hi, uint row) {
  AxisInterval a;
  a.mixed = !(lo > HR_MIXED_DIRECTION) && !(hi < -HR_MIXED_DIRECTION);
  const bool backwards = hi < -HR_MIXED_DIRECTION;
  a.near_row = row + (backwards ? HR_W : 0);
  a.far_row = row + (backwards ? 0 : HR_W);
  a.near_rate = backwards ? 1 / lo : 1 / max(hi, HR_MIXED_DIRECTION);
  a.far_rate = backwards ? 1 / hi : 1 / lo;
  a.other_near_rate = 1 / min(lo, -HR_MIXED_DIRECTION);
  return a;
}

// Narrows [t_in, t_out] of all children by one axis.
static inline void narrow_interval(global const float* node, const AxisInterval* a, real origin, HR_FLOATW* t_in,
                                   HR_FLOATW* t_out) {
  *t_in = max(*t_in, (HR_SLAB(a->near_row) - origin) * a->near_rate);
  if (a->mixed) {
    *t_in = max(*t_in, (HR_SLAB(a->far_row) - origin) * a->other_near_rate);
  } else {
    *t_out = min(*t_out, (HR_SLAB(a->far_row) - origin) * a->far_rate);
  }
}

// Does any ray of the packet enter child `lane` of the node?
static inline bool any_ray_enters(const Packet* p, global const float* node, uint lane) {
#pragma OPENCL FP_CONTRACT OFF
  const float lo_x = node[lane] - p->origin.x, hi_x = node[HR_W + lane] - p->origin.x;
  const float lo_y = node[2 * HR_W + lane] - p->origin.y, hi_y = node[3 * HR_W + lane] - p->origin.y;
  const float lo_z = node[4 * HR_W + lane] - p->origin.z, hi_z = node[5 * HR_W + lane] - p->origin.z;
  for (uint k = 0; k < HR_K; k++) {
    const float16 x0 = lo_x * p->rx[k], x1 = hi_x * p->rx[k];
    const float16 y0 = lo_y * p->ry[k], y1 = hi_y * p->ry[k];
    const float16 z0 = lo_z * p->rz[k], z1 = hi_z * p->rz[k];
    const float16 t_in = max((float16)(p->t_min), max(max(min(x0, x1), min(y0, y1)), min(z0, z1)));
    const float16 t_out = min(p->t[k], min(min(max(x0, x1), max(y0, y1)), max(z0, z1))) * HR_SLAB_PAD;
    if (any_lane16(t_in <= t_out)) return true;
  }
  return false;
}

// Takes hits of one primitive into group k; ties go to the smaller primitive.
static inline bool take_hits(Packet* p, uint k, int16 met, float16 t, float16 u, float16 v, int primitive) {
  const int16 closer = met & (t > p->t_min) & ((int16)(primitive) != p->skip[k]) &
                       ((t < p->t[k]) | ((t == p->t[k]) & ((int16)(primitive) < p->primitive[k])));
  if (!any_lane16(closer)) return false;
  p->t[k] = select(p->t[k], t, closer);
  p->u[k] = select(p->u[k], u, closer);
  p->v[k] = select(p->v[k], v, closer);
  p->primitive[k] = select(p->primitive[k], (int16)(primitive), closer);
  return true;
}

#if HR_TRIANGLE_WATERTIGHT

// t of group k, of the rays that meet the triangle as a thin one by thin_triangle_t(), ray by ray.
static inline float16 thin_triangle_t16(const Packet* p, uint k, global const float* row, int16 thin, float16 one_end,
                                        float16 other_end, float16 weighted) {
  const real3 a = block_point(row, 0, 0), b = block_point(row, 3, 0), c = block_point(row, 6, 0);
  float16 t = weighted;
  for (uint i = 0; i < 16; i++) {
    if (!((const int*)&thin)[i]) continue;
    const real3 direction =
        (real3)(((const float*)&p->dx[k])[i], ((const float*)&p->dy[k])[i], ((const float*)&p->dz[k])[i]);
    ((float*)&t)[i] = thin_triangle_t(p->origin, direction, a, b, c, ((const float*)&one_end)[i],
                                      ((const float*)&other_end)[i], ((const float*)&weighted)[i]);
  }
  return t;
}

// intersect_triangle() of intersect.h, operation for operation, but one triangle against those of 16 rays whose axis of
// shear is kz.
static inline bool intersect_triangle_along(Packet* p, global const float* row, int kz, int primitive) {
#pragma OPENCL FP_CONTRACT OFF
  const int kx = kz == 2 ? 0 : kz + 1, ky = kx == 2 ? 0 : kx + 1;
  const float okx = pick(p->origin, kx), oky = pick(p->origin, ky), okz = pick(p->origin, kz);
  const float ax0 = row[kx * HR_L] - okx, ay0 = row[ky * HR_L] - oky, az = row[kz * HR_L] - okz;
  const float bx0 = row[(3 + kx) * HR_L] - okx, by0 = row[(3 + ky) * HR_L] - oky, bz = row[(3 + kz) * HR_L] - okz;
  const float cx0 = row[(6 + kx) * HR_L] - okx, cy0 = row[(6 + ky) * HR_L] - oky, cz = row[(6 + kz) * HR_L] - okz;
  const float nearest = min(min(az, bz), cz), farthest = max(max(az, bz), cz);
  bool any = false;
  for (uint k = 0; k < HR_K; k++) {
    if (!(p->axes[k] >> kz & 1u)) continue;
    const float16 sx = p->sx[k], sy = p->sy[k];
    const float16 ax = fma(sx, (float16)(az), (float16)(ax0)), ay = fma(sy, (float16)(az), (float16)(ay0));
    const float16 bx = fma(sx, (float16)(bz), (float16)(bx0)), by = fma(sy, (float16)(bz), (float16)(by0));
    const float16 cx = fma(sx, (float16)(cz), (float16)(cx0)), cy = fma(sy, (float16)(cz), (float16)(cy0));
    float16 wa = cx * by - cy * bx;
    float16 wb = ax * cy - ay * cx;
    float16 wc = bx * ay - by * ax;
    int16 met = all_of_one_sign16(wa, wb, wc);
    if (!any_lane16(met)) continue;
    met &= p->axis[k] == kz;
    const int16 doubtful = met & ((wa == 0.0f) | (wb == 0.0f) | (wc == 0.0f));
    if (any_lane16(doubtful)) {
      wa = select(wa, exact_edge_function16(cx, cy, bx, by), doubtful);
      wb = select(wb, exact_edge_function16(ax, ay, cx, cy), doubtful);
      wc = select(wc, exact_edge_function16(bx, by, ax, ay), doubtful);
      met &= all_of_one_sign16(wa, wb, wc);
    }
    float16 det = wa + wb + wc;
    met &= det != 0.0f;
    float16 depth_det = fma(wa, (float16)(az), fma(wb, (float16)(bz), wc * cz));
    int16 thin = (int16)(0);
    if (HR_HAS(THIN_TRIANGLES)) {
      const float16 reach = max(max(max(fabs(ax), fabs(ay)), max(fabs(bx), fabs(by))), max(fabs(cx), fabs(cy)));
      thin = met & HR_IS_THIN(farthest - nearest, reach, max(fabs(nearest), fabs(farthest)), depth_det);
    }
    const bool any_thin = HR_HAS(THIN_TRIANGLES) && any_lane16(thin);
    if (any_thin) {
      wa = select(wa, exact_edge_function16(cx, cy, bx, by), thin);
      wb = select(wb, exact_edge_function16(ax, ay, cx, cy), thin);
      wc = select(wc, exact_edge_function16(bx, by, ax, ay), thin);
      det = wa + wb + wc;
      depth_det = fma(wa, (float16)(az), fma(wb, (float16)(bz), wc * cz));
    }
    const float16 inverse_det = 1.0f / det;
    float16 t = p->sz[k] * depth_det * inverse_det;
    if (any_thin) t = thin_triangle_t16(p, k, row, thin, p->sz[k] * nearest, p->sz[k] * farthest, t);
    any |= take_hits(p, k, met, t, wb * inverse_det, wc * inverse_det, primitive);
  }
  return any;
}

static inline bool intersect_packet_triangle(Packet* p, global const float* block, uint lane, int primitive) {
  bool any = false;
  for (int kz = 0; kz < 3; kz++) {
    if (p->all_axes >> kz & 1u) any |= intersect_triangle_along(p, block + lane, kz, primitive);
  }
  return any;
}

static inline void intersect_packet_block(const SceneView* view, Packet* p, global const float* block, bool* updated) {
  for (uint lane = 0; lane < HR_L; lane++) {
    const uint primitive = block_primitive(block, lane);
    if (primitive >= view->triangle_count) continue;
    if (intersect_packet_triangle(p, block, lane, (int)primitive)) *updated = true;
  }
}

#else

static inline HR_FLOATL upper_bound(HR_FLOATL x, HR_FLOATL y, HR_FLOATL z, const float* least, const float* most) {
  return max(x * least[0], x * most[0]) + max(y * least[1], y * most[1]) + max(z * least[2], z * most[2]);
}

// With a common origin o the volumes are dot products of a direction with three vectors a triangle (Davidovič et al.
// 2012, "3D Rasterization: A Bridge Between Rasterization and Ray Casting"); bounds over all directions discard most
// triangles of a block at once.
static inline void intersect_packet_block(const SceneView* view, Packet* p, global const float* block, bool* updated) {
  const float *least = p->least, *most = p->most;
  const HR_FLOATL ox = HR_ROW(0) - p->origin.x, oy = HR_ROW(1) - p->origin.y, oz = HR_ROW(2) - p->origin.z;
  const HR_FLOATL e1x = HR_ROW(3), e1y = HR_ROW(4), e1z = HR_ROW(5);
  const HR_FLOATL e2x = HR_ROW(6), e2y = HR_ROW(7), e2z = HR_ROW(8);
  HR_FLOATL nx = e2y * e1z - e2z * e1y, ny = e2z * e1x - e2x * e1z, nz = e2x * e1y - e2y * e1x;
  HR_FLOATL t_det = nx * ox + ny * oy + nz * oz;
  const HR_INTL sign = HR_AS_INTL(t_det) & (HR_INTL)(0x80000000);
  t_det = HR_FLIP(t_det);
  nx = HR_FLIP(nx);
  ny = HR_FLIP(ny);
  nz = HR_FLIP(nz);
  const HR_FLOATL ux = HR_FLIP(e2y * oz - e2z * oy), uy = HR_FLIP(e2z * ox - e2x * oz),
                  uz = HR_FLIP(e2x * oy - e2y * ox);
  const HR_FLOATL vx = HR_FLIP(e1y * oz - e1z * oy), vy = HR_FLIP(e1z * ox - e1x * oz),
                  vz = HR_FLIP(e1x * oy - e1y * ox);
  const HR_FLOATL det_bound = upper_bound(nx, ny, nz, least, most);
  const HR_FLOATL u_bound = upper_bound(ux, uy, uz, least, most), v_bound = upper_bound(vx, vy, vz, least, most);
  const HR_FLOATL w_bound = upper_bound(nx - ux - vx, ny - uy - vy, nz - uz - vz, least, most);
  const HR_FLOATL slack = det_bound * -1e-5f;  // of rounding in the bounds
  HR_INTL may = (t_det > 0.0f) & (det_bound > 0.0f) & (u_bound >= slack) & (v_bound >= slack) & (w_bound >= slack) &
                (t_det <= det_bound * p->t_most * HR_INTERVAL_FAR);
  if (HR_HAS_ONE_BY_ONE) {
    may &= *(global const HR_INTL*)(block + HR_BLOCK_PRIMITIVE_ROW * HR_L) < (HR_INTL)((int)view->triangle_count);
  }
  LaneSet lanes = HR_LANES_OF_L(may);
  if (!lanes) return;
  float q[10][HR_L];
  HR_STORE(HR_L, nx, q[0]);
  HR_STORE(HR_L, ny, q[1]);
  HR_STORE(HR_L, nz, q[2]);
  HR_STORE(HR_L, ux, q[3]);
  HR_STORE(HR_L, uy, q[4]);
  HR_STORE(HR_L, uz, q[5]);
  HR_STORE(HR_L, vx, q[6]);
  HR_STORE(HR_L, vy, q[7]);
  HR_STORE(HR_L, vz, q[8]);
  HR_STORE(HR_L, t_det, q[9]);
  do {
    const uint lane = first_lane(lanes);
    lanes = without_first(lanes);
    const int primitive = (int)block_primitive(block, lane);
    for (uint k = 0; k < HR_K; k++) {
      const float16 x = p->dx[k], y = p->dy[k], z = p->dz[k];
      const float16 det = x * q[0][lane] + y * q[1][lane] + z * q[2][lane];
      const float16 u = x * q[3][lane] + y * q[4][lane] + z * q[5][lane];
      const float16 v = x * q[6][lane] + y * q[7][lane] + z * q[8][lane];
      const int16 met =
          (u >= 0.0f) & (v >= 0.0f) & (u + v <= det) & (q[9][lane] <= det * (p->t[k] * HR_SLAB_PAD)) & (det > 0.0f);
      if (!any_lane16(met)) continue;
      const float16 inverse_det = 1.0f / det;
      if (take_hits(p, k, met, q[9][lane] * inverse_det, u * inverse_det, v * inverse_det, primitive)) *updated = true;
    }
  } while (lanes);
}

#endif

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

static inline float most_t(const Packet* p) {
  float16 t = p->t[0];
  for (uint k = 1; k < HR_K; k++) t = max(t, p->t[k]);
  return most_of16(t);
}

// With `any`, a ray that has hit something is finished: its t drops below all others.
static inline void finish_hit_rays(Packet* p) {
  for (uint k = 0; k < HR_K; k++) p->t[k] = select(p->t[k], (float16)(-1.0f), p->primitive[k] != -1);
}

// Traces the packet; hits are in t, u, v, primitive afterwards (only primitive with `any`).
static inline void traverse_packet(const SceneView* view, Packet* p, bool any) {
  AxisInterval axes[3];
  for (uint i = 0; i < 3; i++) axes[i] = make_axis_interval(p->least[i], p->most[i], 2 * i * HR_W);
  if (HR_HAS(PLANES)) {
    intersect_packet_planes(view, p);
    if (any) finish_hit_rays(p);
  }
  p->t_most = most_t(p);
  StackEntry stack[HR_TRAVERSAL_STACK];
  uint size = 0;
  int at = 0;
  if (HR_HAS(INSTANCES)) stack[size++] = HR_ENTRY(0.0f, instance_root(view));
  for (;;) {
    if (at >= 0) {
      global const float* node = node_at(view, at);
      HR_FLOATW t_in = (HR_FLOATW)(p->t_min), t_out = (HR_FLOATW)(p->t_most);
      narrow_interval(node, &axes[0], p->origin.x, &t_in, &t_out);
      narrow_interval(node, &axes[1], p->origin.y, &t_in, &t_out);
      narrow_interval(node, &axes[2], p->origin.z, &t_in, &t_out);
      LaneSet entered = 0;
      for (LaneSet rest = HR_LANES_OF_W(t_in * HR_INTERVAL_NEAR <= t_out * HR_INTERVAL_FAR); rest;
           rest = without_first(rest)) {
        const uint lane = first_lane(rest);
        if (any_ray_enters(p, node, lane)) entered |= lane_bit(lane);
      }
      if (entered) {
        float t_near[HR_W] HR_ALIGN_AS_VECTOR(HR_W);
        *(HR_FLOATW*)t_near = t_in;
        at = any ? last_child(node, entered, t_near, stack, &size)
                 : nearest_child(view, node, entered, t_near, stack, &size);
        continue;
      }
    } else {
      const uint leaf = (uint)~at;
      global const float* block = block_at(view, leaf >> 4);
      bool updated = false;
      if (HR_HAS(INSTANCES) && is_instance_leaf(at)) intersect_packet_instance(view, p, at, &updated);
      for (uint n = leaf & 15u; n > 0; n--, block += HR_BLOCK_ROWS * HR_L) {
        if (HR_HAS(TRIANGLES)) intersect_packet_block(view, p, block, &updated);
        if (HR_HAS_ONE_BY_ONE) intersect_packet_others(view, p, block, &updated);
      }
      if (updated) {
        if (any) finish_hit_rays(p);
        p->t_most = most_t(p);
        if (p->t_most < 0) return;
      }
    }
    StackEntry entry = 0;
    bool found = false;
    while (size > 0 && !found) {
      entry = stack[--size];
      found = as_float((uint)(entry >> 32)) * HR_INTERVAL_NEAR <= p->t_most * HR_INTERVAL_FAR;
    }
    if (!found) return;
    at = (int)(uint)entry;
  }
}

#endif

#endif
