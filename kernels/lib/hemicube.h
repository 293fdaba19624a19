// Hemicubes over patches: where they stand, their frames, and the directions through their cells. Cells are numbered in
// shared/radiosity_types.h.
#ifndef HR_LIB_HEMICUBE_H
#define HR_LIB_HEMICUBE_H

#include "lib/math.h"
#include "lib/offset.h"
#include "lib/rng.h"
#include "shared/radiosity_types.h"

#define HR_DIMENSION_TURN 101u
#define HR_DIMENSION_CELL 102u

// Where rays start, and the frame.
typedef struct Hemicube {
  real3 origin;
  real3 tangent, bitangent, normal;
} Hemicube;

// Directions through a face: along p + up q + out, p from -1 to 1, q from `low` to 1.
typedef struct HemicubeFace {
  real3 along, up, out;
  real low;
  uint rows;  // of n cells each
} HemicubeFace;

// Sample `sample` of divisions^2: the centroid of one of the congruent triangles into which parallels to the edges cut
// the side. Barycentric weights of the second and third vertex.
static inline real2 sample_weights(uint sample, uint divisions) {
  const uint row = (uint)square_root((real)sample);  // exact: sample < 2^20; row r holds 2 r + 1 triangles from r^2 on
  const uint at = sample - row * row;
  const bool upright = (at & 1u) == 0;
  const real third = REAL(1.0) / 3;
  // Rows count from the first vertex: in lattice coordinates (i, j), i + j = row, upright triangles have their first
  // vertex there and their middle a third of a step on.
  const real j = (real)(at / 2), i = (real)(row - at / 2);
  const real u = upright ? i + third : i - third, v = upright ? j + third : j + 2 * third;
  return (real2)(divide(u, (real)divisions), divide(v, (real)divisions));
}

// Over a sample point of a side of the triangle a, b, c.
static inline Hemicube make_hemicube(real3 a, real3 b, real3 c, uint side, uint sample, const HemicubeParams* cube) {
  const real2 w = sample_weights(sample, cube->divisions);
  const real3 wa = a * (1 - w.x - w.y), wb = b * w.x, wc = c * w.y;
  Hemicube h;
  const real3 outward = normal_of_edges(b - a, c - a);
  h.normal = side & 1u ? -outward : outward;
  const real3 along = normalize3(b - a), across = cross3(h.normal, along);
  real2 turn = (real2)(0, 1);  // sine, cosine
  if (cube->turned) {
    turn = sincos_turn(rng_unit(rng_hash((uint4)(side, sample, 0, HR_DIMENSION_TURN ^ cube->seed_key)).x));
  }
  h.tangent = along * turn.y + across * turn.x;
  h.bitangent = across * turn.y - along * turn.x;
  h.origin = offset_origin(wa + wb + wc, (fabs(wa) + fabs(wb) + fabs(wc)) * HR_GAMMA(7), h.normal, h.normal);
  return h;
}

// Face 0 is the top, 1 to 4 are the others, n cells along the longer edges.
static inline HemicubeFace hemicube_face(const Hemicube* h, uint face, uint n) {
  HemicubeFace f = {h->tangent, h->bitangent, h->normal, -REAL(1.0), n};
  if (face == 0) return f;
  f.out = (face < 3 ? h->tangent : h->bitangent) * (face & 1u ? REAL(1.0) : -REAL(1.0));
  f.along = face < 3 ? h->bitangent : h->tangent;
  f.up = h->normal;
  f.low = 0;
  f.rows = n / 2;
  return f;
}

// The number of the face's first cell.
static inline uint first_cell(uint face, uint n) { return face == 0 ? 0 : n * n + (face - 1) * (n * n / 2); }

// Through a cell, at `place` in [0, 1)^2 of it.
static inline real3 cell_direction(const HemicubeFace* f, uint n, uint x, uint y, real2 place) {
  const real step_size = divide(2, (real)n);
  const real p = ((real)x + place.x) * step_size - 1, q = ((real)y + place.y) * step_size + f->low;
  return f->along * p + f->up * q + f->out;
}

#endif
