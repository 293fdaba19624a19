// Queries for arrays of rays in which neighbours start from one point: packets (lib/packet.h). A packet whose rays do
// not is traced ray by ray, so the answer is right whatever is asked.
#include "lib/packet.h"
#include "lib/query_ray.h"

#if HR_EXPLICIT_VECTORS

static inline bool same_point(QueryRay a, QueryRay b) {
  return a.origin.x == b.origin.x && a.origin.y == b.origin.y && a.origin.z == b.origin.z && a.origin.w == b.origin.w;
}

// Loads rays [first, first + HR_PACKET_RAYS), the last one again beyond `count`; false if they cannot go together.
static inline bool load_packet(global const QueryRay* rays, uint first, uint count, Packet* p, float* least,
                               float* most) {
  const QueryRay head = rays[first];
  p->origin = (real3)(head.origin.x, head.origin.y, head.origin.z);
  p->t_min = head.origin.w;
  bool together = true;
  float16 lo_x = (float16)(INFINITY), lo_y = lo_x, lo_z = lo_x, hi_x = -lo_x, hi_y = hi_x, hi_z = hi_x;
  for (uint k = 0; k < HR_K; k++) {
    float x[16], y[16], z[16], t[16];
    for (uint i = 0; i < 16; i++) {
      const QueryRay ray = rays[min(first + 16 * k + i, count - 1)];
      together = together && same_point(ray, head);
      x[i] = ray.direction.x;
      y[i] = ray.direction.y;
      z[i] = ray.direction.z;
      t[i] = ray.direction.w;
    }
    p->dx[k] = *(const float16*)x;
    p->dy[k] = *(const float16*)y;
    p->dz[k] = *(const float16*)z;
    p->t[k] = *(const float16*)t;
    lo_x = min(lo_x, p->dx[k]);
    lo_y = min(lo_y, p->dy[k]);
    lo_z = min(lo_z, p->dz[k]);
    hi_x = max(hi_x, p->dx[k]);
    hi_y = max(hi_y, p->dy[k]);
    hi_z = max(hi_z, p->dz[k]);
    const float16 tiny = (float16)(HR_TINY_DIRECTION);
    p->rx[k] = 1.0f / select(p->dx[k], copysign(tiny, p->dx[k]), fabs(p->dx[k]) < tiny);
    p->ry[k] = 1.0f / select(p->dy[k], copysign(tiny, p->dy[k]), fabs(p->dy[k]) < tiny);
    p->rz[k] = 1.0f / select(p->dz[k], copysign(tiny, p->dz[k]), fabs(p->dz[k]) < tiny);
    p->u[k] = (float16)(0.0f);
    p->v[k] = (float16)(0.0f);
    p->primitive[k] = (int16)(-1);
  }
  least[0] = least_of16(lo_x);
  least[1] = least_of16(lo_y);
  least[2] = least_of16(lo_z);
  most[0] = most_of16(hi_x);
  most[1] = most_of16(hi_y);
  most[2] = most_of16(hi_z);
#if HR_TRIANGLE_WATERTIGHT
  // One shear axis for all: the one along which every direction is longest against the others.
  float reach[3];
  for (uint i = 0; i < 3; i++) reach[i] = least[i] > 0 ? least[i] : (most[i] < 0 ? -most[i] : 0.0f);
  p->kz = reach[0] > reach[1] ? (reach[0] > reach[2] ? 0 : 2) : (reach[1] > reach[2] ? 1 : 2);
  p->kx = p->kz == 2 ? 0 : p->kz + 1;
  p->ky = p->kx == 2 ? 0 : p->kx + 1;
  // A steeper shear than this would cost digits; a single ray's is at most 1.
  const float side = max(max(-least[p->kx], most[p->kx]), max(-least[p->ky], most[p->ky]));
  together = together && side <= 2 * reach[p->kz] && reach[p->kz] > 0;
  for (uint k = 0; k < HR_K; k++) {
    const float16 d[3] = {p->dx[k], p->dy[k], p->dz[k]};
    p->sz[k] = 1.0f / d[p->kz];
    p->sx[k] = -(d[p->kx] * p->sz[k]);
    p->sy[k] = -(d[p->ky] * p->sz[k]);
  }
#endif
  return together;
}

// hits[i] = closest hit of rays[i]. Launch: one item a packet.
kernel void query_packets_intersect(HR_SCENE_PARAMETERS global const QueryRay* restrict rays,
                                    global QueryHit* restrict hits, const uint count, const RenderParams params) {
  const uint first = (uint)get_global_id(0) * HR_PACKET_RAYS;
  if (first >= count) return;
  HR_MAKE_SCENE_VIEW(params)
  Packet packet;
  float least[3], most[3];
  if (!load_packet(rays, first, count, &packet, least, most)) {
    for (uint i = first; i < min(count, first + HR_PACKET_RAYS); i++) hits[i] = query_closest(&view, rays[i]);
    return;
  }
  traverse_packet(&view, &packet, least, most, false);
  for (uint k = 0; k < HR_K; k++) {
    float t[16], u[16], v[16];
    int primitive[16];
    *(float16*)t = packet.t[k];
    *(float16*)u = packet.u[k];
    *(float16*)v = packet.v[k];
    *(int16*)primitive = packet.primitive[k];
    for (uint i = 0; i < 16 && first + 16 * k + i < count; i++) {
      const QueryHit result = {t[i], u[i], v[i], (uint)primitive[i]};
      hits[first + 16 * k + i] = result;
    }
  }
}

// occluded[i] = 1 if rays[i] meets anything, else 0. Launch: one item a packet.
kernel void query_packets_occluded(HR_SCENE_PARAMETERS global const QueryRay* restrict rays,
                                   global uint* restrict occluded, const uint count, const RenderParams params) {
  const uint first = (uint)get_global_id(0) * HR_PACKET_RAYS;
  if (first >= count) return;
  HR_MAKE_SCENE_VIEW(params)
  Packet packet;
  float least[3], most[3];
  if (!load_packet(rays, first, count, &packet, least, most)) {
    for (uint i = first; i < min(count, first + HR_PACKET_RAYS); i++) occluded[i] = query_any(&view, rays[i]);
    return;
  }
  traverse_packet(&view, &packet, least, most, true);
  for (uint k = 0; k < HR_K; k++) {
    int primitive[16];
    *(int16*)primitive = packet.primitive[k];
    for (uint i = 0; i < 16 && first + 16 * k + i < count; i++) occluded[first + 16 * k + i] = primitive[i] != -1;
  }
}

#endif
