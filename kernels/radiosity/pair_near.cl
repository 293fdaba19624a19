// Exchange areas of pairs that touch, are close, or are cut by each other's plane: the parts in front of each other, by
// the double integral along their contours (Sparrow 1963), A_i F_ij = 1 / (2 pi) sum of edges e.f int int ln r ds dt;
// the inner integral in closed form, the outer by Gauss's rule on halves that shrink towards where it is not smooth.
// `real` is double where the device has it: the sum cancels.
#include "lib/accel_layout.h"
#include "lib/vec.h"
#include "shared/pair_types.h"

#ifdef HR_DOUBLE
#define HR_CONTOUR_HALVINGS 14u
#else
#define HR_CONTOUR_HALVINGS 8u
#endif

// As many of Gauss's nodes as one item does at once.
#if !HR_EXPLICIT_VECTORS
#define HR_Q 1u
typedef real realq;
static inline realq load_nodes(constant const real* p) { return *p; }
static inline real sum_nodes(realq a) { return a; }
#else
#define HR_Q 8u
#ifdef HR_DOUBLE
typedef double8 realq;
#else
typedef float8 realq;
#endif
static inline realq load_nodes(constant const real* p) { return vload8(0, p); }
static inline real sum_nodes(realq a) { return ((a.s0 + a.s1) + (a.s2 + a.s3)) + ((a.s4 + a.s5) + (a.s6 + a.s7)); }
#endif

#define HR_NEAR_COLUMNS 256u
#define HR_PARALLEL_SINE2 REAL(1e-10)

typedef struct Polygon {
  real3 v[4];
  uint count;
} Polygon;

static inline Polygon load_side(global const float4* corners, uint side) {
  Polygon p;
  for (uint k = 0; k < 3; k++) {
    const float4 v = corners[3 * side + k];
    p.v[k] = (real3)((real)v.x, (real)v.y, (real)v.z);
  }
  p.v[3] = p.v[0];
  p.count = 3;
  return p;
}

// What of a triangle is in front of a plane; heights within `slack` count as in it.
static inline Polygon clip_to_front(const Polygon* p, real3 point, real3 normal, real slack) {
  Polygon out;
  out.count = 0;
  real h[3];
  for (uint k = 0; k < 3; k++) {
    h[k] = dot3(normal, p->v[k] - point);
    if (fabs(h[k]) <= slack) h[k] = 0;
  }
  for (uint k = 0; k < 3; k++) {
    const uint next = k == 2 ? 0 : k + 1;
    if (h[k] >= 0) out.v[out.count++] = p->v[k];
    if ((h[k] > 0 && h[next] < 0) || (h[k] < 0 && h[next] > 0)) {
      // From the same end whoever asks.
      out.v[out.count++] = p->v[k] + (p->v[next] - p->v[k]) * (h[k] / (h[k] - h[next]));
    }
  }
  return out;
}

constant real gauss_nodes[8] = {REAL(0.019855071751231884), REAL(0.10166676129318664), REAL(0.2372337950418355),
                                REAL(0.4082826787521751),   REAL(0.5917173212478249),  REAL(0.7627662049581645),
                                REAL(0.8983332387068134),   REAL(0.9801449282487681)};
constant real gauss_weights[8] = {REAL(0.05061426814518813), REAL(0.11119051722668723), REAL(0.15685332293894363),
                                  REAL(0.18134189168918099), REAL(0.18134189168918099), REAL(0.15685332293894363),
                                  REAL(0.11119051722668723), REAL(0.05061426814518813)};

// t (ln sqrt(t^2 + d^2) - 1), 0 at t = 0.
static inline realq log_part(realq t, realq d2) {
  const realq tiny = (realq)(REAL(1e-37));
  return t * (REAL(0.5) * log(max(t * t + d2, tiny)) - 1);
}

// int ln |x - y| over the edge y from `start`, of that direction and length, for x on a line from the start of the
// edge e at parameters s.
static inline realq inner_integral(real3 x0, real3 along, realq s, real3 start, real3 direction, real length) {
  const realq x = (x0.x - start.x) + along.x * s, y = (x0.y - start.y) + along.y * s,
              z = (x0.z - start.z) + along.z * s;
  const realq foot = x * direction.x + y * direction.y + z * direction.z;
  const realq px = x - foot * direction.x, py = y - foot * direction.y, pz = z - foot * direction.z;
  const realq d2 = px * px + py * py + pz * pz, d = sqrt(d2);
  const realq t0 = -foot, t1 = length - foot;
  return log_part(t1, d2) - log_part(t0, d2) + d * atan2(length * d, d2 + t0 * t1);
}

static inline real distance_to_segment(real3 x, real3 start, real3 direction, real length) {
  const real3 to = x - start;
  const real3 off = to - direction * clamp(dot3(to, direction), (real)0, length);
  return sqrt(dot3(off, off));
}

// int int ln r along two edges.
static real edge_integral(real3 a, real3 along, real length_a, real3 b, real3 direction, real length_b) {
  const real3 turned = cross3(along, direction);
  const bool parallel = dot3(turned, turned) < HR_PARALLEL_SINE2;
  real sum = 0;
  uint at = 0, depth = 0;  // the interval [at, at + 1] / 2^depth
  for (;;) {
    const real size = length_a / (real)(1u << depth), begin = (real)at * size;
    const real3 middle = a + along * (begin + REAL(0.5) * size);
    const real3 to_start = middle - b, to_end = to_start - direction * length_b;
    real room = min(sqrt(dot3(to_start, to_start)), sqrt(dot3(to_end, to_end)));
    if (!parallel) room = min(room, distance_to_segment(middle, b, direction, length_b));
    if (room < size && depth < HR_CONTOUR_HALVINGS) {
      at *= 2;
      depth++;
      continue;
    }
    real part = 0;
    for (uint k = 0; k < 8; k += HR_Q) {
      const realq s = begin + load_nodes(gauss_nodes + k) * size;
      part += sum_nodes(load_nodes(gauss_weights + k) * inner_integral(a, along, s, b, direction, length_b));
    }
    sum += size * part;
    at++;
    while (depth > 0 && (at & 1u) == 0) {
      at >>= 1;
      depth--;
    }
    if (depth == 0) break;
  }
  return sum;
}

// The sum over the contours of both, lengths in units of `unit`: logarithms then cancel least.
static real contour_exchange(const Polygon* p, const Polygon* q, real unit) {
  const real3 origin = p->v[0];
  const real scale = 1 / unit;
  real sum = 0;
  for (uint i = 0; i < p->count; i++) {
    const real3 a = (p->v[i] - origin) * scale, e = (p->v[i + 1 == p->count ? 0 : i + 1] - p->v[i]) * scale;
    const real length_a = sqrt(dot3(e, e));
    if (!(length_a > 0)) continue;
    for (uint j = 0; j < q->count; j++) {
      const real3 b = (q->v[j] - origin) * scale, f = (q->v[j + 1 == q->count ? 0 : j + 1] - q->v[j]) * scale;
      const real length_b = sqrt(dot3(f, f));
      const real cosine = dot3(e, f);
      if (!(length_b > 0) || fabs(cosine) < REAL(1e-13) * length_a * length_b) continue;
      const real ra = 1 / length_a, rb = 1 / length_b;
      sum += cosine * ra * rb * edge_integral(a, e * ra, length_a, b, f * rb, length_b);
    }
  }
  return sum * unit * unit * REAL(0.15915494309189535);
}

// Of the pair i < j.
static real near_exchange(global const float4* corners, global const float* sides, uint stride, float flatness, uint i,
                          uint j) {
  const Polygon whole_i = load_side(corners, i), whole_j = load_side(corners, j);
  const real3 cross_i = cross3(whole_i.v[1] - whole_i.v[0], whole_i.v[2] - whole_i.v[0]),
              cross_j = cross3(whole_j.v[1] - whole_j.v[0], whole_j.v[2] - whole_j.v[0]);
  const real3 normal_i = cross_i / sqrt(dot3(cross_i, cross_i)), normal_j = cross_j / sqrt(dot3(cross_j, cross_j));
  const real3 away = whole_j.v[0] - whole_i.v[0];
  const real distance = sqrt(dot3(away, away));
#ifdef HR_DOUBLE
  const real slack_i = 0, slack_j = 0;  // corners that both share are in the plane exactly
#else
  const real slack_i = flatness + sides[HR_SIDE_SLOPE * stride + i] * distance,
             slack_j = flatness + sides[HR_SIDE_SLOPE * stride + j] * distance;
#endif
  const Polygon p = clip_to_front(&whole_i, whole_j.v[0], normal_j, slack_j);
  const Polygon q = clip_to_front(&whole_j, whole_i.v[0], normal_i, slack_i);
  if (p.count < 3 || q.count < 3) return 0;
  const real reach = (real)(sides[HR_SIDE_RADIUS * stride + i] + sides[HR_SIDE_RADIUS * stride + j]);
  return max(contour_exchange(&p, &q, max(distance, reach)), (real)0);
}

// Puts their exchange areas in place of all HR_PAIR_IS_NEAR, and counts them by row. Launch: one item a row.
kernel void radiosity_pair_near(global const float4* restrict corners, global const float* restrict sides,
                                const uint stride, const float flatness, const uint first, const uint row_count,
                                global float* restrict dense, global uint* restrict near_counts) {
  const uint at = (uint)get_global_id(0);
  if (at >= row_count) return;
  const uint i = first + at;
  uint count = 0;
  for (uint j = 0; j < stride; j++) {
    global float* g = dense + (ulong)at * stride + j;
    if (*g != HR_PAIR_IS_NEAR) continue;
    *g = (float)near_exchange(corners, sides, stride, flatness, min(i, j), max(i, j));
    count++;
  }
  near_counts[i] = count;
}
