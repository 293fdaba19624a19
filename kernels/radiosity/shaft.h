// What can lie between two triangles: the blockers that reach into their convex hull (Haines and Wallace 1991, "Shaft
// Culling"), few enough to test rays against each of them. All places are from the `origin` of the shaft.
#ifndef HR_RADIOSITY_SHAFT_H
#define HR_RADIOSITY_SHAFT_H

#include "lib/surface.h"
#include "lib/traverse.h"
#include "radiosity/wide.h"

#define HR_SHAFT_PLANES 12u   /* a hull has six sides at most, but edges of one plane may give one each */
#define HR_SHAFT_BLOCKERS 24u /* a private array: so many that walls and furniture never fill it */

typedef struct Shaft {
  float3 corners[6], origin;
  float4 planes[HR_SHAFT_PLANES];  // outside: dot3(p, xyz) + w <= 0
  uint plane_count;
  float flatness;
} Shaft;

// A plane, and those through the edges that stand on it, to the inside: all >= 0 in the triangle.
typedef struct Blocker {
  float4 plane, edges[3];
} Blocker;

static inline float height_over(float4 plane, float3 p) { return dot3(plane.xyz, p) + plane.w; }

static inline void add_shaft_plane(Shaft* s, float4 plane) {
  if (s->plane_count < HR_SHAFT_PLANES) s->planes[s->plane_count++] = plane;
}

// The plane through an edge of one triangle and a corner of the other, if all corners are on one side of it.
static inline void try_shaft_plane(Shaft* s, float3 a, float3 b, float3 c) {
  const float3 n = cross3(b - a, c - a);
  const float length2 = dot3(n, n);
  if (!(length2 > 0)) return;
  const float3 unit = n * rsqrt(length2);
  float least = 0, most = 0;
  for (uint k = 0; k < 6; k++) {
    const float h = dot3(unit, s->corners[k] - a);
    least = min(least, h);
    most = max(most, h);
  }
  const float at = dot3(unit, a);
  if (least >= -s->flatness) add_shaft_plane(s, (float4)(unit, s->flatness - at - least));
  if (most <= s->flatness) add_shaft_plane(s, (float4)(-unit, s->flatness + at + most));
}

// Corners 0 to 2 and 3 to 5 are the two triangles; `front`: their planes, outside what is not in front of them.
static inline void make_shaft(Shaft* s, float4 front, float4 other_front) {
  s->plane_count = 0;
  add_shaft_plane(s, front);
  add_shaft_plane(s, other_front);
  for (uint k = 0; k < 3; k++) {
    const uint next = k == 2 ? 0 : k + 1;
    for (uint c = 0; c < 3; c++) {
      try_shaft_plane(s, s->corners[k], s->corners[next], s->corners[3 + c]);
      try_shaft_plane(s, s->corners[3 + k], s->corners[3 + next], s->corners[c]);
    }
  }
}

static inline bool box_is_outside(const Shaft* s, float3 middle, float3 half_size) {
  bool outside = false;
  for (uint k = 0; k < s->plane_count; k++) {
    const float4 p = s->planes[k];
    outside |= height_over(p, middle) + dot3(fabs(p.xyz), half_size) <= 0;
  }
  return outside;
}

// False if no ray between the two triangles can meet it.
static inline bool make_blocker(const Shaft* s, const TriangleGeometry* g, Blocker* out) {
  const float3 v[3] = {g->a - s->origin, g->b - s->origin, g->c - s->origin};
  const float3 n = normal_of_edges(v[1] - v[0], v[2] - v[0]);
  out->plane = (float4)(n, -dot3(n, v[0]));
  float least = INFINITY, most = -INFINITY;
  for (uint k = 0; k < 6; k++) {
    const float h = height_over(out->plane, s->corners[k]);
    least = min(least, h);
    most = max(most, h);
  }
  if (least >= -s->flatness || most <= s->flatness) return false;
  for (uint k = 0; k < s->plane_count; k++) {
    const float4 p = s->planes[k];
    if (max(max(height_over(p, v[0]), height_over(p, v[1])), height_over(p, v[2])) <= 0) return false;
  }
  for (uint k = 0; k < 3; k++) {
    const float3 inward = cross3(n, v[k == 2 ? 0 : k + 1] - v[k]);
    out->edges[k] = (float4)(inward, -dot3(inward, v[k]));
  }
  return true;
}

// The blockers in the shaft but for two, or HR_SHAFT_BLOCKERS + 1 of them if there are more.
static uint find_blockers(const SceneView* view, const Shaft* s, uint own, uint other, Blocker* blockers) {
  uint count = 0, size = 0;
  int stack[HR_TRAVERSAL_STACK + 1], at = 0;
  for (;;) {
    if (at >= 0) {
      global const float* node = node_at(view, at);
      global const int* children = node_children(node);
      for (uint lane = 0; lane < HR_W; lane++) {
        const float3 lo = (float3)(node[lane], node[2 * HR_W + lane], node[4 * HR_W + lane]) - s->origin,
                     hi = (float3)(node[HR_W + lane], node[3 * HR_W + lane], node[5 * HR_W + lane]) - s->origin;
        if (!(lo.x <= hi.x) || box_is_outside(s, (lo + hi) * 0.5f, (hi - lo) * 0.5f)) continue;
        stack[size++] = children[lane];
      }
    } else {
      const uint leaf = (uint)~at;
      global const float* block = block_at(view, leaf >> 4);
      for (uint n = leaf & 15u; n > 0; n--, block += HR_BLOCK_ROWS * HR_L) {
        for (uint lane = 0; lane < HR_L; lane++) {
          const uint primitive = block_primitive(block, lane);
          if (primitive >= view->triangle_count || primitive == own || primitive == other) continue;
          const TriangleGeometry g = load_triangle(view, primitive);
          Blocker blocker;
          if (!make_blocker(s, &g, &blocker)) continue;
          if (count == HR_SHAFT_BLOCKERS) return HR_SHAFT_BLOCKERS + 1;
          blockers[count++] = blocker;
        }
      }
    }
    if (size == 0) return count;
    at = stack[--size];
  }
}

static inline floatp heights_over(float4 plane, const floatp* p) {
  return dot_lanes((floatp)(plane.x), (floatp)(plane.y), (floatp)(plane.z), p[0], p[1], p[2]) + plane.w;
}

// Which of the ways from `from` to `to` it blocks.
static inline intp blocked_by(const Blocker* b, const floatp* from, const floatp* to) {
  const floatp h = heights_over(b->plane, from), g = heights_over(b->plane, to);
  intp met = h * g < 0.0f;
  if (!any_lane(met)) return met;
  const floatp part = h / (h - g);
  floatp p[3];
  for (uint c = 0; c < 3; c++) p[c] = fma(part, to[c] - from[c], from[c]);
  for (uint k = 0; k < 3; k++) met &= heights_over(b->edges[k], p) >= 0.0f;
  return met;
}

#endif
