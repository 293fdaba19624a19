// A packet against the triangles of a leaf's block, watertight or fast.
#ifndef HR_LIB_PACKET_TRIANGLE_H
#define HR_LIB_PACKET_TRIANGLE_H

#include "lib/edge_function.h"
#include "lib/packet_hits.h"

#if HR_PACKETS
#include "lib/packet_cone.h"
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

static inline void intersect_packet_lane(const SceneView* view, Packet* p, global const float* block, uint lane,
                                         bool* updated) {
  const uint primitive = block_primitive(block, lane);
  if (primitive < view->triangle_count && intersect_packet_triangle(p, block, lane, (int)primitive)) *updated = true;
}

static inline void intersect_packet_block(const SceneView* view, Packet* p, const PacketCone* cone,
                                          global const float* block, bool* updated) {
  if (cone->kz < 0) {
    for (uint lane = 0; lane < HR_L; lane++) intersect_packet_lane(view, p, block, lane, updated);
    return;
  }
  for (LaneSet rest = lanes_in_cone(cone, p->origin, block); rest; rest = without_first(rest)) {
    intersect_packet_lane(view, p, block, first_lane(rest), updated);
  }
}

#else

static inline HR_FLOATL upper_bound(HR_FLOATL x, HR_FLOATL y, HR_FLOATL z, const float* least, const float* most) {
  return max(x * least[0], x * most[0]) + max(y * least[1], y * most[1]) + max(z * least[2], z * most[2]);
}

// With a common origin o the volumes are dot products of a direction with three vectors a triangle (Davidovič et al.
// 2012, "3D Rasterization: A Bridge Between Rasterization and Ray Casting"); bounds over all directions discard most
// triangles of a block at once.
static inline void intersect_packet_block(const SceneView* view, Packet* p, const PacketCone* cone,
                                          global const float* block, bool* updated) {
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

#endif

#endif
