// Octree, k-d tree and median k-d tree: their hits are those of brute force and of the BVH, bit for bit; every cell
// lists what touches it; builds repeat.
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

#include "host/base/error.hpp"
#include "tests/bvh/cell_walk.hpp"
#include "tests/bvh/query_bench.hpp"

namespace hemiray {
namespace {

using test::add_sphere;
using test::add_triangle;
using test::cell_kinds;
using test::cell_options;
using test::CellKind;
using test::CellWalk;
using test::empty_flat_scene;
using test::Hits;
using test::make_ray;
using test::Places;
using test::QueryBench;
using test::Rays;
using test::soup;
using test::TreeWorkshop;
using test::vertex;

// Scenes that are hard on trees of cells.
FlatScene duplicates(std::uint32_t count) {
  FlatScene flat = empty_flat_scene();
  for (std::uint32_t i = 0; i < count; i++)
    add_triangle(flat, {0.3F, 0.1F, 0}, {0.9F, 0.2F, 0.1F}, {0.5F, 0.8F, -0.3F});
  return flat;
}

FlatScene planar(std::uint32_t count, int axis) {
  FlatScene flat = empty_flat_scene();
  Places places(31);
  for (std::uint32_t i = 0; i < count; i++) {
    Vec3 a = places.in_cube(1.0F), b = a + places.in_cube(0.2F), c = a + places.in_cube(0.2F);
    a[axis] = b[axis] = c[axis] = 0.25F;
    add_triangle(flat, a, b, c);
  }
  return flat;
}

// Down to 2^-20 m: edge functions of triangles far to the side of a ray are then mostly rounding.
FlatScene huge_and_tiny() {
  FlatScene flat = empty_flat_scene();
  Places places(32);
  for (int i = 0; i < 400; i++) {
    const float size = std::exp2(places.in(-20.0F, 6.0F));
    const Vec3 at = places.in_cube(1.0F);
    add_triangle(flat, at, at + size * places.direction(), at + size * places.direction());
    if (i % 3 == 0) add_sphere(flat, places.in_cube(1.0F), std::exp2(places.in(-9.0F, 4.0F)));
  }
  return flat;
}

FlatScene slivers(int count) {
  FlatScene flat = empty_flat_scene();
  Places places(33);
  for (int i = 0; i < count; i++) {
    const Vec3 a = places.in_cube(1.0F), d = places.direction();
    add_triangle(flat, a, a + 1.5F * d, a + 0.75F * d + 1e-3F * places.direction());
  }
  return flat;
}

FlatScene one_code() {  // two far ones stretch the lattice: all others fall into one Morton cell
  FlatScene flat = empty_flat_scene();
  Places places(34);
  add_triangle(flat, Vec3(-2e5F), Vec3(-2e5F) + Vec3(1, 0, 0), Vec3(-2e5F) + Vec3(0, 1, 0));
  for (int i = 0; i < 300; i++) {
    const Vec3 a = places.in_cube(1.0F);
    add_triangle(flat, a, a + places.in_cube(0.3F), a + places.in_cube(0.3F));
  }
  add_triangle(flat, Vec3(2e5F), Vec3(2e5F) + Vec3(1, 0, 0), Vec3(2e5F) + Vec3(0, 1, 0));
  return flat;
}

// At the tree's own planes, at points where two or three of them cross, and within them, give or take 3 ulps.
Rays rays_at_planes(const CellWalk& walk, std::size_t count, std::uint32_t seed) {
  Places places(seed);
  Rays rays;
  if (walk.planes.empty()) return rays;
  const auto some_plane = [&] { return walk.planes[places.below(static_cast<std::uint32_t>(walk.planes.size()))]; };
  while (rays.size() < count) {
    Vec3 origin = places.in_cube(2.0F), target = places.in_cube(1.0F);
    const std::size_t way = rays.size() % 4;
    for (std::size_t n = 0; n < 1 + way % 3; n++) {
      const auto [axis, plane] = some_plane();
      target[axis] = plane;
      if (way == 3) origin[axis] = plane;  // in the plane
    }
    target = test::moved_by_ulps(target, places);
    if (way != 3 || rays.size() % 8 == 3) origin = test::moved_by_ulps(origin, places);
    if (origin != target) rays.push_back(make_ray(origin, target - origin));
  }
  return rays;
}

// A component of the direction that counts as zero: the ray may lie in the plane of flat boxes, and the BVH then names
// another of two neighbours than brute force does. Cells are wider than that.
bool is_along_axes(const shared::QueryRay& ray) {
  const shared::float4& d = ray.direction;
  return std::min({std::abs(d.x), std::abs(d.y), std::abs(d.z)}) < 1e-17F;
}

// Every kind finds what brute force finds, on rays of all sorts, and what the BVH finds.
void check_scene(TreeWorkshop& workshop, const std::string& name, const FlatScene& flat, std::size_t count) {
  QueryBench boxes(workshop, flat, cell_options(AccelKind::bvh, 8, 8, 1));
  Rays rays = test::random_rays(count, 41);
  if (!flat.triangles.empty()) {
    const Rays aimed = test::aimed_rays(flat, count, 42);
    rays.insert(rays.end(), aimed.begin(), aimed.end());
  }
  const Hits expected = boxes.brute_force(rays);
  const Hits by_boxes = boxes.queries.intersect(rays);
  if (flat.triangles.size() + flat.spheres.size() > 2) CHECK(test::count_found(expected) > rays.size() / 100);
  for (const CellKind& kind : cell_kinds()) {
    INFO(name << ", " << kind.name);
    QueryBench bench(workshop, flat, kind.options);
    const Hits hits = bench.queries.intersect(rays);
    CHECK(test::count_different(rays, hits, expected) == 0);
    CHECK(test::count_disagreeing(hits, bench.queries.occluded(rays)) == 0);
    Rays oblique;
    Hits oblique_hits, oblique_expected;
    for (std::size_t i = 0; i < rays.size(); i++) {
      if (is_along_axes(rays[i])) continue;
      oblique.push_back(rays[i]);
      oblique_hits.push_back(hits[i]);
      oblique_expected.push_back(by_boxes[i]);
    }
    CHECK(test::count_different(oblique, oblique_hits, oblique_expected) == 0);
    const Rays at_planes = rays_at_planes(CellWalk(bench.tree.accel), count / 4, 43);
    if (at_planes.empty()) continue;
    const Hits plane_hits = bench.queries.intersect(at_planes);
    CHECK(test::count_different(at_planes, plane_hits, boxes.brute_force(at_planes)) == 0);
    CHECK(test::count_disagreeing(plane_hits, bench.queries.occluded(at_planes)) == 0);
  }
}

// Points of a primitive's surface.
std::vector<Vec3> surface_points(const FlatScene& flat, std::uint32_t primitive, Places& places) {
  std::vector<Vec3> points;
  for (int i = 0; i < 12; i++) {
    if (primitive < flat.triangles.size()) {
      const shared::uint4 t = flat.triangles[primitive];
      const Vec3 a = vertex(flat, t.x), b = vertex(flat, t.y), c = vertex(flat, t.z);
      const float u = i < 2 ? static_cast<float>(i) : places.in(0.0F, 1.0F), v = places.in(0.0F, 1.0F - u);
      points.push_back(a + u * (b - a) + v * (c - a));
    } else {
      const shared::float4 s = flat.spheres[primitive - flat.triangles.size()].center_radius;
      points.push_back(Vec3(s.x, s.y, s.z) + s.w * places.direction());
    }
  }
  return points;
}

bool contains(const CellWalk::Leaf& leaf, const Vec3& p) {
  return glm::all(glm::lessThanEqual(leaf.lo, p)) && glm::all(glm::lessThanEqual(p, leaf.hi));
}

bool lists(const CellWalk::Leaf& leaf, std::uint32_t primitive) {
  return std::find(leaf.primitives.begin(), leaf.primitives.end(), primitive) != leaf.primitives.end();
}

// Every leaf that holds a point of a primitive lists it, and some leaf does; a leaf lists nothing twice; the statistics
// tell what is there.
void check_cells(TreeWorkshop& workshop, const std::string& name, const FlatScene& flat, const CellKind& kind) {
  INFO(name << ", " << kind.name);
  const test::BuiltTree tree(workshop, flat, kind.options);
  const AccelStatistics& statistics = tree.accel.statistics();
  const CellWalk walk(tree.accel);
  CHECK(statistics.references == walk.references);
  CHECK(statistics.nodes == walk.nodes);
  CHECK(statistics.depth == walk.deepest);
  std::size_t twice = 0, unlisted = 0, lost = 0;
  for (CellWalk::Leaf leaf : walk.leaves) {
    std::sort(leaf.primitives.begin(), leaf.primitives.end());
    twice += std::adjacent_find(leaf.primitives.begin(), leaf.primitives.end()) != leaf.primitives.end();
  }
  Places places(44);
  for (std::uint32_t i = 0; i < flat.triangles.size() + flat.spheres.size(); i++) {
    for (const Vec3& p : surface_points(flat, i, places)) {
      std::size_t holding = 0;
      for (const CellWalk::Leaf& leaf : walk.leaves) {
        if (!contains(leaf, p)) continue;
        holding++;
        unlisted += !lists(leaf, i);
      }
      lost += holding == 0;
    }
  }
  CHECK(twice == 0);
  CHECK(unlisted == 0);
  CHECK(lost == 0);
}

}  // namespace

TEST_CASE("all kinds of trees find what brute force and the BVH find: 100,000 random rays and as many aimed ones") {
  TreeWorkshop workshop;
  check_scene(workshop, "triangles and spheres", soup(400, 100, 0.2F, 40), 100000);
}

TEST_CASE("all kinds of trees find what brute force and the BVH find: hardly anything") {
  TreeWorkshop workshop;
  check_scene(workshop, "nothing", empty_flat_scene(), 1000);
  check_scene(workshop, "one triangle", soup(1, 0, 1.0F, 35), 20000);
  check_scene(workshop, "two triangles", soup(2, 0, 1.0F, 36), 20000);
  check_scene(workshop, "one sphere", soup(0, 1, 1.0F, 37), 20000);
}

TEST_CASE("all kinds of trees find what brute force and the BVH find: where cutting is of no use") {
  TreeWorkshop workshop;
  check_scene(workshop, "duplicates", duplicates(300), 10000);
  check_scene(workshop, "one Morton code", one_code(), 10000);
  check_scene(workshop, "slivers", slivers(600), 10000);
  check_scene(workshop, "huge and tiny", huge_and_tiny(), 10000);
}

TEST_CASE("all kinds of trees find what brute force and the BVH find: flat and closed scenes") {
  TreeWorkshop workshop;
  for (int axis = 0; axis < 3; axis++) {
    check_scene(workshop, "planar, axis " + std::to_string(axis), planar(400, axis), 10000);
  }
  check_scene(workshop, "spheres", soup(0, 300, 0.3F, 39), 10000);
  check_scene(workshop, "box", test::closed_mesh(8, false, Vec3(0.0F)), 10000);
  check_scene(workshop, "ball", test::closed_mesh(8, true, Vec3(0.0F)), 10000);
}

TEST_CASE("no ray slips between cells, or out of a closed mesh") {
  TreeWorkshop workshop;
  for (const bool round : {true, false}) {
    for (const Vec3 offset : {Vec3(0.0F), Vec3(100.0F)}) {
      const FlatScene mesh = test::closed_mesh(16, round, offset);
      const Rays rays = test::rays_from_inside(mesh, 30000, 45);
      for (std::size_t k = 0; k < 3; k++) {
        INFO((round ? "ball" : "box") << " at " << offset.x << ", " << cell_kinds()[k].name);
        QueryBench bench(workshop, mesh, cell_kinds()[k].options, false);
        CHECK(test::count_found(bench.queries.intersect(rays)) == rays.size());
        const std::vector<std::uint32_t> occluded = bench.queries.occluded(rays);
        CHECK(std::count(occluded.begin(), occluded.end(), 0U) == 0);
      }
    }
  }
}

TEST_CASE("cells list what touches them") {
  TreeWorkshop workshop;
  for (const CellKind& kind : cell_kinds()) {
    check_cells(workshop, "both", soup(400, 100, 0.2F, 46), kind);
    check_cells(workshop, "slivers", slivers(300), kind);
    check_cells(workshop, "duplicates", duplicates(300), kind);
    check_cells(workshop, "huge and tiny", huge_and_tiny(), kind);
    check_cells(workshop, "planar", planar(300, 2), kind);
    check_cells(workshop, "nothing", empty_flat_scene(), kind);
  }
}

TEST_CASE("cells do not list what only touches with its box") {
  TreeWorkshop workshop;
  const FlatScene flat = slivers(300);
  FlatScene hollow = empty_flat_scene();
  Places places(47);
  for (int i = 0; i < 300; i++) add_sphere(hollow, places.in_cube(1.0F), places.in(0.3F, 0.6F));
  for (const FlatScene* scene : {&flat, static_cast<const FlatScene*>(&hollow)}) {
    for (std::size_t k = 0; k < 3; k++) {
      const test::BuiltTree tree(workshop, *scene, cell_kinds()[k].options);
      const CellWalk walk(tree.accel);
      std::size_t boxes = 0;
      for (const CellWalk::Leaf& leaf : walk.leaves) {
        for (std::uint32_t i = 0; i < scene->triangles.size() + scene->spheres.size(); i++) {
          Vec3 lo, hi;
          if (scene == &flat) {
            const shared::uint4 t = flat.triangles[i];
            const Vec3 a = vertex(flat, t.x), b = vertex(flat, t.y), c = vertex(flat, t.z);
            lo = glm::min(glm::min(a, b), c);
            hi = glm::max(glm::max(a, b), c);
          } else {
            const shared::float4 s = scene->spheres[i].center_radius;
            lo = Vec3(s.x, s.y, s.z) - s.w;
            hi = Vec3(s.x, s.y, s.z) + s.w;
          }
          boxes += glm::all(glm::lessThanEqual(lo, leaf.hi)) && glm::all(glm::lessThanEqual(leaf.lo, hi));
        }
      }
      INFO((scene == &flat ? "slivers, " : "spheres, ")
           << cell_kinds()[k].name << ": " << walk.references << " of " << boxes);
      CHECK(static_cast<double>(walk.references) < (scene == &flat ? 0.75 : 0.95) * static_cast<double>(boxes));
    }
  }
}

TEST_CASE("trees of cells have few references, and big leaves where cutting is of no use") {
  TreeWorkshop workshop;
  for (const CellKind& kind : cell_kinds()) {
    INFO(kind.name);
    const FlatScene hair = slivers(3000), small = soup(5000, 0, 0.02F, 48);
    CHECK(test::BuiltTree(workshop, hair, kind.options).accel.statistics().references <= 30000);
    const test::BuiltTree tree(workshop, small, kind.options);
    CHECK(tree.accel.statistics().references >= 5000);
    CHECK(tree.accel.statistics().references <= 25000);
    CHECK(tree.accel.statistics().depth >= 3);
    CHECK(tree.accel.statistics().stack_depth <= tree.accel.config().stack);
    const FlatScene copies = duplicates(500);
    const test::BuiltTree pile(workshop, copies, kind.options);
    const CellWalk walk(pile.accel);
    CHECK(walk.leaves.front().primitives.size() >= 500 / 8);
  }
}

TEST_CASE("ten builds of a tree of cells are the same bytes") {
  TreeWorkshop workshop;
  const FlatScene flat = soup(5000, 500, 0.05F, 49);
  for (std::size_t k = 0; k < 3; k++) {
    INFO(cell_kinds()[k].name);
    std::vector<float> nodes, blocks;
    for (int build = 0; build < 10; build++) {
      const test::BuiltTree tree(workshop, flat, cell_kinds()[k].options);
      const std::vector<float> nodes_now = tree.accel.nodes().read(), blocks_now = tree.accel.blocks().read();
      if (build == 0) {
        nodes = nodes_now;
        blocks = blocks_now;
      }
      REQUIRE(nodes_now.size() == nodes.size());
      REQUIRE(blocks_now.size() == blocks.size());
      CHECK(std::memcmp(nodes_now.data(), nodes.data(), nodes.size() * sizeof(float)) == 0);
      CHECK(std::memcmp(blocks_now.data(), blocks.data(), blocks.size() * sizeof(float)) == 0);
    }
  }
}

TEST_CASE("refit makes a tree of cells anew, queries stay valid") {
  TreeWorkshop workshop;
  const FlatScene before = soup(500, 50, 0.2F, 50), after = soup(500, 50, 0.4F, 51);
  const Rays rays = test::random_rays(10000, 52);
  const Hits expected = QueryBench(workshop, after).brute_force(rays);
  const DeviceScene moved(workshop.context, after, test::kAllPrimitives);
  for (std::size_t k = 0; k < 3; k++) {
    INFO(cell_kinds()[k].name);
    const DeviceScene scene(workshop.context, before, test::kAllPrimitives);
    Accel accel(workshop.builder, scene, cell_kinds()[k].options);
    RayQueries queries(workshop.context, moved, accel, true);
    accel.refit(moved);
    CHECK(accel.statistics().primitives == 550);
    CHECK(test::count_different(rays, queries.intersect(rays), expected) == 0);
  }
}

TEST_CASE("trees have names") {
  CHECK(parse_accel("bvh").kind == AccelKind::bvh);
  CHECK(parse_accel("bvh").width == 0);
  CHECK(parse_accel("bvh2").kind == AccelKind::bvh);
  CHECK(parse_accel("bvh2").width == 2);
  CHECK(parse_accel("octree").kind == AccelKind::octree);
  CHECK(parse_accel("kdtree").kind == AccelKind::kdtree);
  CHECK(parse_accel("kdtree-median").kind == AccelKind::kdtree_median);
  CHECK_THROWS_AS(parse_accel(""), InputError);
  CHECK_THROWS_AS(parse_accel("bvh4"), InputError);
}

}  // namespace hemiray
