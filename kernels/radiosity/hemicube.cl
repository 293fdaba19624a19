// Form factors by ray-cast hemicubes (Cohen and Greenberg 1985, "The Hemi-Cube"): a ray through every cell of a cube
// over the side's sample points; what it meets first receives the cell's form factor.
#include "lib/hemicube.h"
#include "lib/packet.h"
#include "lib/surface.h"

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

static inline uint tiles_of(uint width, uint height) {
  return ((width + HR_TILE_WIDTH - 1) / HR_TILE_WIDTH) * ((height + HR_TILE_HEIGHT - 1) / HR_TILE_HEIGHT);
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
  const TriangleGeometry own = load_triangle(&view, side / 2);
  const Hemicube h = make_hemicube(own.a, own.b, own.c, side, which % samples, &cube);

  const uint face = tile < top_tiles ? 0 : 1 + (tile - top_tiles) / face_tiles;
  if (face > 0) tile = (tile - top_tiles) % face_tiles;
  const HemicubeFace f = hemicube_face(&h, face, n);
  const uint across = (n + HR_TILE_WIDTH - 1) / HR_TILE_WIDTH;
  const uint x0 = tile % across * HR_TILE_WIDTH, y0 = tile / across * HR_TILE_HEIGHT;
  global uint* out = seen + which * (3 * n * n) + first_cell(face, n);
#if HR_PACKETS
  Packet packet;
  open_packet(&packet, h.origin, 0, h.normal);
#endif
  for (uint i = 0; i < HR_TILE_CELLS; i++) {
    const uint x = x0 + i % HR_TILE_WIDTH, y = y0 + i / HR_TILE_WIDTH;
    if (x >= n || y >= f.rows) continue;
    real2 place = (real2)(REAL(0.5));
    if (cube.jittered) {
      const uint4 random =
          rng_hash((uint4)(side, which % samples, (face * n + y) * n + x, HR_DIMENSION_CELL ^ cube.seed_key));
      place = (real2)(rng_unit(random.x), rng_unit(random.y));
    }
    const real3 direction = cell_direction(&f, n, x, y, place);
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
    if (x >= n || y >= f.rows) continue;
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
