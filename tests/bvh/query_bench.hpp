// One scene with its tree and its queries, brute force beside them, and the rays that tests ask with.
#pragma once

#include <catch2/catch.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include "host/bvh/ray_queries.hpp"
#include "tests/bvh/flat_shapes.hpp"
#include "tests/support/kernel_folder.hpp"

namespace hemiray::test {

using Rays = std::vector<shared::QueryRay>;
using Hits = std::vector<shared::QueryHit>;

inline constexpr std::uint32_t kMiss = HR_NO_PRIMITIVE;
inline constexpr float kForever = std::numeric_limits<float>::infinity();

inline shared::QueryRay make_ray(Vec3 origin, Vec3 direction, float t_min = 0.0F, float t_max = kForever) {
  return {{origin.x, origin.y, origin.z, t_min}, {direction.x, direction.y, direction.z, t_max}};
}

// All lanes of all blocks in turn with the kernels' own test of one lane: no boxes, no vectors. What the tree must
// find, bit for bit in a strict build.
inline constexpr const char* kBruteForce = R"(#include "lib/traverse.h"
kernel void brute_intersect(HR_SCENE_PARAMETERS global const QueryRay* restrict rays, global QueryHit* restrict hits,
                            const uint blocks, const RenderParams params) {
  const uint i = (uint)get_global_id(0);
  HR_MAKE_SCENE_VIEW(params)
  const QueryRay q = rays[i];
  const Ray ray = make_ray((real3)(q.origin.x, q.origin.y, q.origin.z),
                           (real3)(q.direction.x, q.direction.y, q.direction.z), q.origin.w, q.direction.w);
  const Skip skip = {HR_NO_PRIMITIVE, 1, 0};
  Hit best = {ray.t_max, 0, 0, HR_NO_PRIMITIVE}, candidate;
  for (uint k = 0; k < blocks * HR_L + view.plane_count; k++) {
    const bool met = k < blocks * HR_L
                         ? intersect_lane(world_numbers(&view), block_at(&view, k / HR_L), k % HR_L, &ray, best.t,
                                          &candidate)
                         : intersect_plane_primitive(&view, &ray, k - blocks * HR_L, &skip, &candidate);
    if (!met || !(candidate.t < ray.t_max)) continue;
    if (candidate.t < best.t || (candidate.t == best.t && candidate.primitive < best.primitive)) best = candidate;
  }
  const QueryHit result = {(float)best.t, (float)best.u, (float)best.v, best.primitive};
  hits[i] = result;
}
)";

inline std::string describe(const shared::QueryRay& ray, const shared::QueryHit& hit,
                            const shared::QueryHit& expected) {
  const auto number = [](float x) {
    std::array<char, 32> text{};
    std::snprintf(text.data(), text.size(), " %.9g", static_cast<double>(x));
    return std::string(text.data());
  };
  return "origin" + number(ray.origin.x) + number(ray.origin.y) + number(ray.origin.z) + ", direction" +
         number(ray.direction.x) + number(ray.direction.y) + number(ray.direction.z) + ": t" + number(hit.t) +
         " primitive " + std::to_string(hit.primitive) + ", expected t" + number(expected.t) + " primitive " +
         std::to_string(expected.primitive);
}

/// Rays whose hits differ in any bit; says so of the first.
inline std::size_t count_different(const Rays& rays, const Hits& hits, const Hits& expected) {
  REQUIRE(hits.size() == rays.size());
  REQUIRE(expected.size() == rays.size());
  std::size_t different = 0;
  for (std::size_t i = 0; i < rays.size(); i++) {
    if (std::memcmp(&hits[i], &expected[i], sizeof hits[i]) == 0) continue;
    if (different++ == 0) UNSCOPED_INFO("ray " << i << ": " << describe(rays[i], hits[i], expected[i]));
  }
  return different;
}

/// Rays of which occluded() says something else than intersect().
inline std::size_t count_disagreeing(const Hits& hits, const std::vector<std::uint32_t>& occluded) {
  REQUIRE(hits.size() == occluded.size());
  std::size_t different = 0;
  for (std::size_t i = 0; i < hits.size(); i++) {
    if (occluded[i] == (hits[i].primitive != kMiss ? 1U : 0U)) continue;
    if (different++ == 0) UNSCOPED_INFO("ray " << i << ": occluded " << occluded[i] << ", hit " << hits[i].primitive);
  }
  return different;
}

inline std::size_t count_found(const Hits& hits) {
  return static_cast<std::size_t>(
      std::count_if(hits.begin(), hits.end(), [](const shared::QueryHit& hit) { return hit.primitive != kMiss; }));
}

/// One scene, its tree, its queries.
class QueryBench {
 public:
  QueryBench(TreeWorkshop& workshop, const FlatScene& flat, const AccelOptions& options = {}, bool strict = true)
      : workshop_(workshop), tree(workshop, flat, options), queries(workshop.context, tree.scene, tree.accel, strict) {}

  Hits brute_force(const Rays& rays) {
    const KernelFolder folder("probe/brute.cl", kBruteForce);
    Program program(workshop_.context, "brute", {"probe/brute.cl"},
                    tree.accel.program_options(tree.scene.features(), true));
    return trace(program.kernel("brute_intersect"), rays, {arg("blocks", tree.accel.statistics().blocks)});
  }

  /// The closest hits by the query kernels compiled with `defines` besides the tree's own.
  Hits intersect_with(const Rays& rays, const std::string& defines) {
    ProgramOptions options = tree.accel.program_options(tree.scene.features(), true);
    options.defines += " " + defines;
    Program program(workshop_.context, "query", {"bvh/query.cl"}, options);
    return trace(program.kernel("query_intersect"), rays, {arg("count", static_cast<std::uint32_t>(rays.size()))});
  }

 private:
  Hits trace(Kernel& kernel, const Rays& rays, const Arguments& own) {
    const Buffer<shared::QueryRay> device_rays(workshop_.context, "rays", std::span<const shared::QueryRay>(rays));
    const Buffer<shared::QueryHit> hits(workshop_.context, "hits", rays.size());
    shared::RenderParams params{};
    params.triangle_count = tree.scene.triangle_count();
    params.sphere_count = tree.scene.sphere_count();
    params.shape_count = tree.scene.shape_count();
    params.plane_count = tree.scene.plane_count();
    launch(workshop_.context, kernel, rays.size(),
           arguments(tree.scene.shading_arguments(), tree.accel.tree_arguments(), arg("rays", device_rays),
                     arg("hits", hits), own, arg("params", params)));
    return hits.read();
  }

  TreeWorkshop& workshop_;

 public:
  BuiltTree tree;
  RayQueries queries;
};

/// Every kind of tree finds what brute force finds, to the bit, and occluded() agrees with intersect(). The fast
/// triangle test comes with slabs that may lose a ray at the rim of a box: `fast_slips` is the share of rays that its
/// trees may answer otherwise.
inline void check_equals_brute_force(TreeWorkshop& workshop, const std::string& name, const FlatScene& flat,
                                     const Rays& rays, double least_hit_share, double fast_slips = 0.0) {
  INFO(name << ", " << rays.size() << " rays");
  const double count = static_cast<double>(rays.size());
  for (const TriangleTest test : {TriangleTest::watertight, TriangleTest::fast}) {
    Hits expected;
    for (const TreeKind& kind : tree_kinds()) {
      if (kind.options.triangle_test != test) continue;
      INFO(kind.name);
      QueryBench bench(workshop, flat, kind.options);
      if (expected.empty()) expected = bench.brute_force(rays);
      const Hits hits = bench.queries.intersect(rays);
      const double slips = test == TriangleTest::fast ? fast_slips * count : 0.0;
      CHECK(static_cast<double>(count_different(rays, hits, expected)) <= slips);
      CHECK(count_disagreeing(hits, bench.queries.occluded(rays)) == 0);
    }
    CHECK(static_cast<double>(count_found(expected)) >= least_hit_share * count);
  }
}

inline Rays random_rays(std::size_t count, std::uint32_t seed, float from = 2.0F) {
  Places places(seed);
  Rays rays;
  while (rays.size() < count) {
    const Vec3 origin = places.in_cube(from);
    rays.push_back(make_ray(origin, rays.size() % 2 == 0 ? places.direction() : places.in_cube(1.0F) - origin));
  }
  return rays;
}

inline float moved_by_ulps(float x, int ulps) {
  for (; ulps > 0; ulps--) x = std::nextafter(x, kForever);
  for (; ulps < 0; ulps++) x = std::nextafter(x, -kForever);
  return x;
}

inline Vec3 moved_by_ulps(Vec3 p, Places& places) {
  const auto some = [&] { return static_cast<int>(places.below(7)) - 3; };
  return {moved_by_ulps(p.x, some()), moved_by_ulps(p.y, some()), moved_by_ulps(p.z, some())};
}

/// From random places to vertices, to points of edges and to the corners of triangles' boxes, give or take 3 ulps.
inline Rays aimed_rays(const FlatScene& flat, std::size_t count, std::uint32_t seed) {
  Places places(seed);
  Rays rays;
  while (rays.size() < count) {
    const shared::uint4 t = flat.triangles[places.below(static_cast<std::uint32_t>(flat.triangles.size()))];
    const Vec3 a = vertex(flat, t.x), b = vertex(flat, t.y), c = vertex(flat, t.z);
    const Vec3 origin = places.in_cube(2.0F);
    Vec3 target = a;
    if (rays.size() % 3 == 1) target = a + places.in(0.0F, 1.0F) * (b - a);
    if (rays.size() % 3 == 2) {
      target = {std::min({a.x, b.x, c.x}), std::max({a.y, b.y, c.y}), std::min({a.z, b.z, c.z})};
    }
    target = moved_by_ulps(target, places);
    rays.push_back(make_ray(origin, target - origin));
  }
  return rays;
}

/// From inside a closed mesh, straight at its vertices and at points of its edges.
inline Rays rays_from_inside(const FlatScene& mesh, std::size_t count, std::uint32_t seed) {
  Places places(seed);
  DVec3 sum(0.0);
  for (std::uint32_t i = 0; i < mesh.positions.size() / 3; i++) sum += DVec3(vertex(mesh, i));
  const Vec3 centre(sum / static_cast<double>(mesh.positions.size() / 3));
  Rays rays;
  while (rays.size() < count) {
    const shared::uint4 t = mesh.triangles[places.below(static_cast<std::uint32_t>(mesh.triangles.size()))];
    const DVec3 a = vertex(mesh, t.x), b = vertex(mesh, t.y);
    const Vec3 origin = centre + (rays.size() % 4 == 0 ? Vec3(0.0F) : places.in_cube(0.4F));
    const DVec3 target = rays.size() % 2 == 0 ? a : a + static_cast<double>(places.in(0.0F, 1.0F)) * (b - a);
    rays.push_back(make_ray(origin, Vec3(target - DVec3(origin))));
  }
  return rays;
}

}  // namespace hemiray::test
