// The wavefront's rays in packets (lib/packet.h): camera rays, and shadow rays traced from a point light to the
// surfaces. A ray that does not fit its packet is traced alone.
#include "lib/packet.h"
#include "path/stages.h"
#include "path/state_arrays.h"

#if HR_PACKETS && HR_ACCEL == HR_ACCEL_BVH

#define HR_PACKET_PARAMETERS                                                                               \
  HR_PATH_STATE(HR_STATE_PARAMETER)                                                                        \
  global uint *restrict next_stage, global const uint *restrict queue, const uint first, const uint count, \
      HR_CONTEXT_PARAMETERS

// What lies so close (relative to the light's distance) in front of a surface is not looked at from the light: t
// carries about 16 roundings, twice that is safe.
#define HR_UNSEEN_END (32 * HR_HALF_ULP)
// Shadow rays longer than so many times their surface's distance from the origin go alone, so that what is not looked
// at stays within 512 roundings of the surface's own coordinates.
#define HR_FAR_LIGHT 16

static inline bool is_same_point(real3 a, real3 b) { return a.x == b.x && a.y == b.y && a.z == b.z; }

// Launch: one item a packet of queue entries [first, first + count).
kernel void path_intersect_closest_packets(HR_PACKET_PARAMETERS) {
  const uint begin = first + (uint)get_global_id(0) * HR_PACKET_RAYS;
  if (begin >= first + count) return;
  const uint rays = min(first + count - begin, (uint)HR_PACKET_RAYS);
  HR_MAKE_CONTEXT
  const real3 origin = xyz(path_ray_origin[queue[begin]]);
  Packet packet;
  open_packet(&packet, origin, 0, xyz(path_ray_direction[queue[begin]]));
  for (uint i = 0; i < rays; i++) {
    const uint slot = queue[begin + i];
    if (is_same_point(xyz(path_ray_origin[slot]), origin) && path_ray_skip[slot] == HR_NO_PRIMITIVE) {
      put_ray(&packet, i, xyz(path_ray_direction[slot]), INFINITY, HR_NO_PRIMITIVE);
    }
  }
  close_packet(&packet);
  traverse_packet(&context.view, &packet, false);
  for (uint i = 0; i < rays; i++) {
    const uint slot = queue[begin + i];
    if (is_in_packet(&packet, i)) {
      const Hit hit = packet_hit(&packet, i);
      path_hit[slot] = (real4)(hit.t, hit.u, hit.v, 0);
      path_hit_primitive[slot] = hit.primitive;
      next_stage[slot] = hit.primitive == HR_NO_PRIMITIVE ? HR_STAGE_shade_miss : HR_STAGE_shade_surface;
      continue;
    }
    const uint loads = HR_GROUP_RAY, stores = HR_GROUP_HIT;
    PathState state;
    HR_PATH_STATE(HR_STATE_LOAD)
    next_stage[slot] = stage_intersect_closest(&context, &state);
    HR_PATH_STATE(HR_STATE_STORE)
  }
}

#if HR_HAS(POINT_LIGHTS) || HR_HAS(SPOT_LIGHTS)

static inline bool is_near(real3 position, real distance) {
  return distance <= HR_FAR_LIGHT * (fabs(position.x) + fabs(position.y) + fabs(position.z));
}

// The first light after `light` that rays of this run go to, counted from 1; 0 if there is none.
static inline uint next_light(global const real4* shadow_direction, global const uint* queue, uint rays, uint light) {
  uint next = 0;
  for (uint i = 0; i < rays; i++) {
    const uint of_ray = (uint)shadow_direction[queue[i]].w;
    if (of_ray > light && (next == 0 || of_ray < next)) next = of_ray;
  }
  return next;
}

// Answers what shadow rays it can, light by light: a free one is left with length 0, a blocked one with -1, for
// path_intersect_shadow to go on from. Which ones does not depend on the packet that a ray is in. Launch: as
// path_intersect_closest_packets.
kernel void path_answer_shadow_packets(HR_PACKET_PARAMETERS) {
  const uint begin = first + (uint)get_global_id(0) * HR_PACKET_RAYS;
  if (begin >= first + count) return;
  const uint rays = min(first + count - begin, (uint)HR_PACKET_RAYS);
  HR_MAKE_SCENE_VIEW(params)
  for (uint light = 0; (light = next_light(path_shadow_direction, queue + begin, rays, light)) != 0;) {
    const real3 origin = param3(view.lights[light - 1].position);
    Packet packet;
    bool opened = false;
    for (uint i = 0; i < rays; i++) {
      const uint slot = queue[begin + i];
      const real4 to = path_shadow_origin[slot];
      if ((uint)path_shadow_direction[slot].w != light || !is_near(xyz(to), to.w)) continue;
      if (!opened) open_packet(&packet, origin, HR_SHADOW_RAY_MARGIN, xyz(to) - origin);
      opened = true;
      put_ray(&packet, i, xyz(to) - origin, 1 - HR_UNSEEN_END, shadow_skip(&view, path_surface[slot]));
    }
    if (!opened) continue;
    close_packet(&packet);
    traverse_packet(&view, &packet, true);
    for (uint i = 0; i < rays; i++) {
      const bool blocked = packet_hit(&packet, i).primitive != HR_NO_PRIMITIVE;
      if (is_in_packet(&packet, i)) path_shadow_origin[queue[begin + i]].w = blocked ? -1 : 0;
    }
  }
}

#endif

#endif
