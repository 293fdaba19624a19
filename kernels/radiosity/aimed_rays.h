// Rays from one point to up to HR_AIMED points: is anything between? A packet where the device has them.
#ifndef HR_RADIOSITY_AIMED_RAYS_H
#define HR_RADIOSITY_AIMED_RAYS_H

#include "lib/packet.h"
#include "lib/surface.h"

// How far a ray to a target goes, in parts of the way, so as not to meet the plane that the target is in: its start is
// at `height` over that, and rounding moves either by about `flatness`.
static inline real way_to(real height, real flatness) { return 1 - divide(2 * flatness, max(height, 2 * flatness)); }

#if HR_PACKETS

#define HR_AIMED HR_PACKET_RAYS

typedef struct AimedRays {
  Packet packet;
  uint skip;
} AimedRays;

// `skip`: the triangle that the origin lies on.
static inline void aim_from(AimedRays* rays, real3 origin, real3 normal, uint skip) {
  open_packet(&rays->packet, origin, 0, normal);
  rays->skip = skip;
}

// The first ray's direction stands in for the lanes without any.
static inline void aim_at(AimedRays* rays, uint lane, real3 target, real way) {
  Packet* p = &rays->packet;
  const real3 direction = target - p->origin;
  bool first = true;
  for (uint k = 0; k < HR_K; k++) first &= p->members[k] == 0;
  if (first) open_packet(p, p->origin, 0, direction);
  put_ray(p, lane, direction, way, rays->skip);
}

static inline void trace_aimed(const SceneView* view, AimedRays* rays) {
  close_packet(&rays->packet);
  traverse_packet(view, &rays->packet, true);
}

static inline bool is_blocked(const AimedRays* rays, uint lane) {
  return packet_hit(&rays->packet, lane).primitive != HR_NO_PRIMITIVE;
}

#else

#define HR_AIMED 64u

typedef struct AimedRays {
  real3 origin, targets[HR_AIMED];
  real ways[HR_AIMED];
  uint skip;
  ulong aimed, blocked;
} AimedRays;

static inline void aim_from(AimedRays* rays, real3 origin, real3 normal, uint skip) {
  rays->origin = origin;
  rays->skip = skip;
  rays->aimed = rays->blocked = 0;
}

static inline void aim_at(AimedRays* rays, uint lane, real3 target, real way) {
  rays->targets[lane] = target;
  rays->ways[lane] = way;
  rays->aimed |= 1ul << lane;
}

static inline void trace_aimed(const SceneView* view, AimedRays* rays) {
  for (uint lane = 0; lane < HR_AIMED; lane++) {
    if (!(rays->aimed >> lane & 1ul)) continue;
    const Ray ray = make_ray(rays->origin, rays->targets[lane] - rays->origin, 0, rays->ways[lane]);
    const Skip skip = {rays->skip, 1, 0};
    if (traverse_any(view, &ray, &skip)) rays->blocked |= 1ul << lane;
  }
}

static inline bool is_blocked(const AimedRays* rays, uint lane) { return (rays->blocked >> lane & 1ul) != 0; }

#endif

#endif
