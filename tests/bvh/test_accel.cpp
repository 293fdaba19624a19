// Invariants of the tree the device builds, over scenes that are hard on it.
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "host/bvh/ray_queries.hpp"
#include "tests/bvh/flat_shapes.hpp"
#include "tests/bvh/tree_check.hpp"

namespace hemiray {
namespace {

using test::add_sphere;
using test::add_triangle;
using test::empty_flat_scene;
using test::Places;
using test::soup;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInf = std::numeric_limits<float>::infinity();

void check_all_kinds(test::TreeWorkshop& workshop, const std::string& name, const FlatScene& flat) {
  for (const test::TreeKind& kind : test::tree_kinds()) {
    INFO(name << "; " << kind.name);
    const test::BuiltTree tree(workshop, flat, kind.options);
    test::TreeCheck(flat, tree.accel, kind.options).run();
  }
}

void add_small_triangle(FlatScene& flat, Vec3 at, float size) {
  add_triangle(flat, at, at + Vec3(size, 0, 0), at + Vec3(0, size, size));
}

// Primitives that must be dropped: seven not finite, six degenerate.
constexpr std::uint32_t kNonFinite = 7, kDegenerate = 6;
void add_bad_primitives(FlatScene& flat) {
  add_triangle(flat, {kNan, 0, 0}, {1, 0, 0}, {0, 1, 0});
  add_triangle(flat, {0, 0, 0}, {1, kInf, 0}, {0, 1, 0});
  add_triangle(flat, {0, 0, 0}, {1, 0, 0}, {0, 1, -kInf});
  add_triangle(flat, {kNan, kNan, kNan}, {kNan, kNan, kNan}, {kNan, kNan, kNan});
  add_sphere(flat, {kNan, 0, 0}, 1.0F);
  add_sphere(flat, {0, 0, 0}, kInf);
  add_sphere(flat, {0, 0, 0}, kNan);
  add_triangle(flat, {1, 2, 3}, {1, 2, 3}, {1, 2, 3});  // a point
  add_triangle(flat, {0, 0, 0}, {1, 1, 1}, {1, 1, 1});  // two corners alike
  add_triangle(flat, {0, 0, 0}, {1, 2, 3}, {2, 4, 6});  // on a line
  add_triangle(flat, {-4, 0, 0}, {4, 0, 0}, {0, 0, 0});
  add_sphere(flat, {0, 0, 0}, 0.0F);
  add_sphere(flat, {0, 0, 0}, -1.0F);
}

}  // namespace

TEST_CASE("the tree holds for every small count and around powers of two") {
  test::TreeWorkshop workshop;
  for (const std::uint32_t count :
       {0U,  1U,  2U,  3U,   4U,   5U,   7U,   8U,   9U,   15U,   16U,   17U,   31U,   32U,   33U,
        63U, 64U, 65U, 127U, 128U, 129U, 255U, 256U, 257U, 1023U, 1024U, 1025U, 4095U, 4096U, 4097U}) {
    check_all_kinds(workshop, std::to_string(count) + " triangles", soup(count, 0, 0.1F, count + 1));
  }
}

TEST_CASE("the tree holds for spheres and for spheres among triangles") {
  test::TreeWorkshop workshop;
  check_all_kinds(workshop, "a sphere", soup(0, 1, 0.1F, 1));
  check_all_kinds(workshop, "two spheres", soup(0, 2, 0.1F, 2));
  check_all_kinds(workshop, "1000 spheres", soup(0, 1000, 0.1F, 3));
  check_all_kinds(workshop, "a triangle and a sphere", soup(1, 1, 0.1F, 4));
  check_all_kinds(workshop, "500 of each", soup(500, 500, 0.2F, 5));
}

TEST_CASE("a sphere's box holds the sphere") {
  test::TreeWorkshop workshop;
  Places places(6);
  for (int i = 0; i < 50; i++) {
    FlatScene flat = empty_flat_scene();
    add_sphere(flat, places.in_cube(std::exp2(places.in(-20.0F, 20.0F))), std::exp2(places.in(-20.0F, 20.0F)));
    const test::BuiltTree tree(workshop, flat);
    const shared::float4 s = flat.spheres[0].center_radius;
    const AccelStatistics& statistics = tree.accel.statistics();
    CHECK(static_cast<double>(statistics.lo.x) <= static_cast<double>(s.x) - static_cast<double>(s.w));
    CHECK(static_cast<double>(statistics.hi.x) >= static_cast<double>(s.x) + static_cast<double>(s.w));
    CHECK(static_cast<double>(statistics.lo.z) <= static_cast<double>(s.z) - static_cast<double>(s.w));
    CHECK(static_cast<double>(statistics.hi.z) >= static_cast<double>(s.z) + static_cast<double>(s.w));
  }
}

TEST_CASE("the tree holds where Morton codes tell nothing apart") {
  test::TreeWorkshop workshop;
  for (const int count : {2, 3, 64, 65, 1000}) {
    FlatScene duplicates = empty_flat_scene();
    for (int i = 0; i < count; i++) add_small_triangle(duplicates, {0.25F, -0.5F, 3.0F}, 1.0F);
    check_all_kinds(workshop, std::to_string(count) + " duplicates", duplicates);
    FlatScene concentric = empty_flat_scene();
    for (int i = 0; i < count; i++) add_sphere(concentric, Vec3(0.0F), 1.0F + static_cast<float>(i));
    check_all_kinds(workshop, std::to_string(count) + " concentric spheres", concentric);
    FlatScene cluster = empty_flat_scene();  // two far ones stretch the grid: all others fall into one cell
    Places places(7);
    add_small_triangle(cluster, Vec3(-1e6F), 1.0F);
    for (int i = 0; i < count; i++) add_small_triangle(cluster, places.in_cube(1e-3F), 1e-3F);
    add_small_triangle(cluster, Vec3(1e6F), 1.0F);
    check_all_kinds(workshop, std::to_string(count) + " in one cell", cluster);
  }
}

TEST_CASE("the tree holds for flat, straight and lopsided scenes") {
  test::TreeWorkshop workshop;
  Places places(8);
  for (int axis = 0; axis < 3; axis++) {
    FlatScene planar = empty_flat_scene(), straight = empty_flat_scene();
    for (int i = 0; i < 777; i++) {
      Vec3 at = places.in_cube(5.0F), b = at + places.in_cube(0.1F), c = at + places.in_cube(0.1F);
      at[axis] = b[axis] = c[axis] = 2.0F;
      add_triangle(planar, at, b, c);
      Vec3 on_line(1.0F);
      on_line[axis] = places.in(-5.0F, 5.0F);
      add_small_triangle(straight, on_line, 0.125F);
    }
    check_all_kinds(workshop, "planar, axis " + std::to_string(axis), planar);
    check_all_kinds(workshop, "centres on a line, axis " + std::to_string(axis), straight);
  }
  FlatScene halving = empty_flat_scene();  // as unbalanced as codes allow
  for (int i = 0; i < 60; i++) add_small_triangle(halving, Vec3(std::exp2(static_cast<float>(-i))), 1e-20F);
  check_all_kinds(workshop, "halving distances", halving);
  check_all_kinds(workshop, "nested", test::nested_triangles(2000, 12));  // deep where neighbours are merged
}

TEST_CASE("the tree holds for huge and tiny things together") {
  test::TreeWorkshop workshop;
  Places places(9);
  FlatScene flat = empty_flat_scene();
  for (int i = 0; i < 500; i++) {
    const float size = std::exp2(places.in(-100.0F, 100.0F));
    add_triangle(flat, size * places.direction(), size * places.direction(), size * places.direction());
    add_sphere(flat, size * places.direction(), size * places.in(0.1F, 1.0F));
  }
  check_all_kinds(workshop, "sizes from 2^-100 to 2^100", flat);
  FlatScene tiny = empty_flat_scene();
  for (int i = 0; i < 100; i++) {
    const Vec3 at = 1e-30F * places.direction();
    add_triangle(tiny, at, at + 1e-30F * places.direction(), at + 1e-30F * places.direction());
  }
  check_all_kinds(workshop, "all of 1e-30 m", tiny);
  CHECK(test::BuiltTree(workshop, tiny).accel.statistics().primitives == 100);
}

TEST_CASE("what is not finite or has no area is dropped and counted, wherever it stands") {
  test::TreeWorkshop workshop;
  FlatScene only_bad = empty_flat_scene();
  add_bad_primitives(only_bad);
  check_all_kinds(workshop, "nothing else", only_bad);
  const test::BuiltTree bad_tree(workshop, only_bad);
  CHECK(bad_tree.accel.statistics().primitives == 0);
  CHECK(bad_tree.accel.statistics().non_finite == kNonFinite);
  CHECK(bad_tree.accel.statistics().degenerate == kDegenerate);
  FlatScene mixed = empty_flat_scene();
  Places places(10);
  add_bad_primitives(mixed);
  for (int i = 0; i < 100; i++) {
    add_small_triangle(mixed, places.in_cube(3.0F), 0.1F);
    add_sphere(mixed, places.in_cube(3.0F), 0.1F);
    if (i % 10 == 0) add_bad_primitives(mixed);
  }
  add_bad_primitives(mixed);
  check_all_kinds(workshop, "among good ones", mixed);
  const test::BuiltTree mixed_tree(workshop, mixed);
  CHECK(mixed_tree.accel.statistics().primitives == 200);
  CHECK(mixed_tree.accel.statistics().non_finite == 12 * kNonFinite);
  CHECK(mixed_tree.accel.statistics().degenerate == 12 * kDegenerate);
}

TEST_CASE("a hundred thousand coincident triangles make a true tree, and rays end at the first") {
  test::TreeWorkshop workshop;
  FlatScene flat = empty_flat_scene();
  for (int i = 0; i < 100000; i++) add_small_triangle(flat, {0.25F, -0.5F, 3.0F}, 1.0F);
  for (const std::size_t k : {0U, 4U}) {
    const test::TreeKind& kind = test::tree_kinds()[k];
    INFO(kind.name);
    const test::BuiltTree tree(workshop, flat, kind.options);
    test::TreeCheck(flat, tree.accel, kind.options).run();
    RayQueries queries(workshop.context, tree.scene, tree.accel);
    const std::vector<shared::QueryRay> rays(100, {{0.9F, -0.4F, 0.0F, 0.0F}, {0.0F, 0.0F, 1.0F, kInf}});
    for (const shared::QueryHit& hit : queries.intersect(rays)) {
      CHECK(hit.primitive == 0);
      CHECK(hit.t > 3.0F);
    }
  }
}

TEST_CASE("a million triangles build a true tree") {
  test::TreeWorkshop workshop;
  const FlatScene flat = soup(1000000, 0, 0.005F, 13);
  const AccelOptions options = complete_options({}, workshop.context.profile());
  const test::BuiltTree tree(workshop, flat, options);
  CHECK(tree.accel.statistics().build_ms > 0.0);
  test::TreeCheck(flat, tree.accel, options).run();
}

}  // namespace hemiray
