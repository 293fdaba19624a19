// Form factors by ray-cast hemicubes (Cohen and Greenberg 1985, "The Hemi-Cube"): a ray through every cell of a cube
// over the side's sample points; what it meets first receives the cell's form factor.
#include "lib/math.h"
#include "lib/offset.h"
#include "lib/packet.h"
#include "lib/rng.h"
#include "lib/surface.h"
#include "shared/radiosity_types.h"

#ifndef HR_LOCAL_SIZE
#define HR_LOCAL_SIZE 64
#endif

// Cells are traced in tiles, which are packets where the device has them.
#define HR_TILE_WIDTH 8u
#if HR_PACKETS
#define HR_TILE_HEIGHT (HR_PACKET_RAYS / HR_TILE_WIDTH)
#else
#define HR_TILE_HEIGHT 8u
#endif
#define HR_TILE_CELLS (HR_TILE_WIDTH * HR_TILE_HEIGHT)

#define HR_DIMENSION_TURN 101u
#define HR_DIMENSION_CELL 102u

static inline uint tiles_of(uint width, uint height) {
  return ((width + HR_TILE_WIDTH - 1) / HR_TILE_WIDTH) * ((height + HR_TILE_HEIGHT - 1) / HR_TILE_HEIGHT);
}

// A hemicube: where its rays start and its frame.
typedef struct Hemicube {
  real3 origin;
  real3 tangent, bitangent, normal;
} Hemicube;

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

static inline Hemicube make_hemicube(const SceneView* view, uint side, uint sample, const HemicubeParams* cube) {
  const TriangleGeometry g = load_triangle(view, side / 2);
  const real2 w = sample_weights(sample, cube->divisions);
  const real3 wa = g.a * (1 - w.x - w.y), wb = g.b * w.x, wc = g.c * w.y;
  Hemicube h;
  const real3 outward = normal_of_edges(g.b - g.a, g.c - g.a);
  h.normal = side & 1u ? -outward : outward;
  const real3 along = normalize3(g.b - g.a), across = cross3(h.normal, along);
  real2 turn = (real2)(0, 1);  // sine, cosine
  if (cube->turned) {
    turn = sincos_turn(rng_unit(rng_hash((uint4)(side, sample, 0, HR_DIMENSION_TURN ^ cube->seed_key)).x));
  }
  h.tangent = along * turn.y + across * turn.x;
  h.bitangent = across * turn.y - along * turn.x;
  h.origin = offset_origin(wa + wb + wc, (fabs(wa) + fabs(wb) + fabs(wc)) * HR_GAMMA(7), h.normal, h.normal);
  return h;
}

// The direction through a cell; `face` 0 is the top, 1 to 4 are the others.
static inline real3 cell_direction(const Hemicube* h, const HemicubeParams* cube, uint face, uint x, uint y,
                                   uint4 random) {
  real2 middle = (real2)(REAL(0.5));
  if (cube->jittered) middle = (real2)(rng_unit(random.x), rng_unit(random.y));
  const real step_size = divide(2, (real)cube->resolution);
  const real p = ((real)x + middle.x) * step_size - 1;
  const real height = ((real)y + middle.y) * step_size;
  if (face == 0) return h->tangent * p + h->bitangent * (height - 1) + h->normal;
  const real3 out = face < 3 ? h->tangent : h->bitangent, along = face < 3 ? h->bitangent : h->tangent;
  return out * (face & 1u ? REAL(1.0) : -REAL(1.0)) + along * p + h->normal * height;
}

// seen[(row samples + sample) cells + cell] = the side that the ray through the cell of the hemicube over sample point
// `sample` of side rows[row] meets first, or HR_NO_SIDE. `patch_normals`: of the triangles, to the front. Launch: one
// item a tile, a hemicube's tiles one after the other.
kernel __attribute__((reqd_work_group_size(HR_LOCAL_SIZE, 1, 1))) void radiosity_trace_hemicubes(
    HR_SCENE_PARAMETERS global const float4* restrict patch_normals, global const uint* restrict rows,
    global uint* restrict seen, const HemicubeParams cube, const RenderParams params) {
  const uint n = cube.resolution;
  const uint top_tiles = tiles_of(n, n), face_tiles = tiles_of(n, n / 2), tiles = top_tiles + 4 * face_tiles;
  const uint samples = cube.divisions * cube.divisions;
  const uint which = (uint)get_global_id(0) / tiles;
  if (which >= cube.row_count * samples) return;
  HR_MAKE_SCENE_VIEW(params)
  uint tile = (uint)get_global_id(0) % tiles;
  const uint side = rows[which / samples];
  const Hemicube h = make_hemicube(&view, side, which % samples, &cube);

  const uint face = tile < top_tiles ? 0 : 1 + (tile - top_tiles) / face_tiles;
  if (face > 0) tile = (tile - top_tiles) % face_tiles;
  const uint across = (n + HR_TILE_WIDTH - 1) / HR_TILE_WIDTH, rows_of_cells = face == 0 ? n : n / 2;
  const uint x0 = tile % across * HR_TILE_WIDTH, y0 = tile / across * HR_TILE_HEIGHT;
  global uint* out = seen + which * (3 * n * n) + (face == 0 ? 0 : n * n + (face - 1) * (n * n / 2));
#if HR_PACKETS
  Packet packet;
  open_packet(&packet, h.origin, 0, h.normal);
#endif
  for (uint i = 0; i < HR_TILE_CELLS; i++) {
    const uint x = x0 + i % HR_TILE_WIDTH, y = y0 + i / HR_TILE_WIDTH;
    if (x >= n || y >= rows_of_cells) continue;
    uint4 random = (uint4)(0);
    if (cube.jittered) {
      random = rng_hash((uint4)(side, which % samples, (face * n + y) * n + x, HR_DIMENSION_CELL ^ cube.seed_key));
    }
    const real3 direction = cell_direction(&h, &cube, face, x, y, random);
#if HR_PACKETS
    put_ray(&packet, i, direction, INFINITY, side / 2);
#else
    const Ray ray = make_ray(h.origin, direction, 0, INFINITY);
    const Skip skip = {side / 2, 1, 0};
    const uint met = traverse_closest(&view, &ray, &skip).primitive;
    uint result = HR_NO_SIDE;
    if (met != HR_NO_PRIMITIVE) result = 2 * met + (dot3(direction, param3(patch_normals[met])) < 0 ? 0u : 1u);
    out[y * n + x] = result;
#endif
  }
#if HR_PACKETS
  close_packet(&packet);
  traverse_packet(&view, &packet, false);
  for (uint i = 0; i < HR_TILE_CELLS; i++) {
    const uint x = x0 + i % HR_TILE_WIDTH, y = y0 + i / HR_TILE_WIDTH;
    if (x >= n || y >= rows_of_cells) continue;
    const uint met = packet_hit(&packet, i).primitive;
    uint result = HR_NO_SIDE;
    if (met != HR_NO_PRIMITIVE) {
      const float4 normal = patch_normals[met];
      const float cosine = ((const float*)packet.dx)[i] * normal.x + ((const float*)packet.dy)[i] * normal.y +
                           ((const float*)packet.dz)[i] * normal.z;
      result = 2 * met + (cosine < 0 ? 0u : 1u);
    }
    out[y * n + x] = result;
  }
#endif
}
