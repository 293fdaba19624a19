// Queries for arrays of rays in which neighbours start from one point: packets (lib/packet.h). A packet whose rays do
// not is traced ray by ray, so the answer is right whatever is asked.
#include "lib/packet.h"
#include "lib/query_ray.h"

#if HR_PACKETS

static inline bool same_point(QueryRay a, QueryRay b) {
  return a.origin.x == b.origin.x && a.origin.y == b.origin.y && a.origin.z == b.origin.z && a.origin.w == b.origin.w;
}

// Rays [first, first + HR_PACKET_RAYS) below `count`; false if they cannot go together.
static inline bool load_packet(global const QueryRay* rays, uint first, uint count, Packet* p) {
  const QueryRay head = rays[first];
  open_packet(p, (real3)(head.origin.x, head.origin.y, head.origin.z), head.origin.w,
              (real3)(head.direction.x, head.direction.y, head.direction.z));
  for (uint i = 0; i < min(count - first, (uint)HR_PACKET_RAYS); i++) {
    const QueryRay ray = rays[first + i];
    if (!same_point(ray, head)) return false;
    put_ray(p, i, (real3)(ray.direction.x, ray.direction.y, ray.direction.z), ray.direction.w, HR_NO_PRIMITIVE);
  }
  close_packet(p);
  return true;
}

// hits[i] = closest hit of rays[i]. Launch: one item a packet.
kernel void query_packets_intersect(HR_SCENE_PARAMETERS global const QueryRay* restrict rays,
                                    global QueryHit* restrict hits, const uint count, const RenderParams params) {
  const uint first = (uint)get_global_id(0) * HR_PACKET_RAYS;
  if (first >= count) return;
  HR_MAKE_SCENE_VIEW(params)
  Packet packet;
  if (!load_packet(rays, first, count, &packet)) {
    for (uint i = first; i < min(count, first + HR_PACKET_RAYS); i++) hits[i] = query_closest(&view, rays[i]);
    return;
  }
  traverse_packet(&view, &packet, false);
  for (uint i = first; i < min(count, first + HR_PACKET_RAYS); i++) {
    const Hit hit = packet_hit(&packet, i - first);
    const QueryHit result = {hit.t, hit.u, hit.v, hit.primitive};
    hits[i] = result;
  }
}

// occluded[i] = 1 if rays[i] meets anything, else 0. Launch: one item a packet.
kernel void query_packets_occluded(HR_SCENE_PARAMETERS global const QueryRay* restrict rays,
                                   global uint* restrict occluded, const uint count, const RenderParams params) {
  const uint first = (uint)get_global_id(0) * HR_PACKET_RAYS;
  if (first >= count) return;
  HR_MAKE_SCENE_VIEW(params)
  Packet packet;
  if (!load_packet(rays, first, count, &packet)) {
    for (uint i = first; i < min(count, first + HR_PACKET_RAYS); i++) occluded[i] = query_any(&view, rays[i]);
    return;
  }
  traverse_packet(&view, &packet, true);
  for (uint i = first; i < min(count, first + HR_PACKET_RAYS); i++) {
    occluded[i] = packet_hit(&packet, i - first).primitive != HR_NO_PRIMITIVE;
  }
}

#endif
