// Invariants of the tree the device builds, over scenes that are hard on it.
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

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

// Only a CPU is known to divide as the host does without being asked to.
bool divides_as_host(const Context& context) { return context.device().kind == DeviceKind::cpu; }

void check_both_code_lengths(test::TreeWorkshop& workshop, const std::string& name, const FlatScene& flat) {
  for (const unsigned bits : {30U, 63U}) {
    INFO(name << ", " << bits << " bits");
    const test::BuiltTree tree(workshop, flat, bits);
    CHECK(tree.accel.statistics().morton_bits == bits);
    test::TreeCheck(flat, tree.accel).run(divides_as_host(workshop.context));
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
    check_both_code_lengths(workshop, std::to_string(count) + " triangles", soup(count, 0, 0.1F, count + 1));
  }
}

TEST_CASE("the tree holds for spheres and for spheres among triangles") {
  test::TreeWorkshop workshop;
  check_both_code_lengths(workshop, "a sphere", soup(0, 1, 0.1F, 1));
  check_both_code_lengths(workshop, "two spheres", soup(0, 2, 0.1F, 2));
  check_both_code_lengths(workshop, "1000 spheres", soup(0, 1000, 0.1F, 3));
  check_both_code_lengths(workshop, "a triangle and a sphere", soup(1, 1, 0.1F, 4));
  check_both_code_lengths(workshop, "500 of each", soup(500, 500, 0.2F, 5));
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
    check_both_code_lengths(workshop, std::to_string(count) + " duplicates", duplicates);
    FlatScene concentric = empty_flat_scene();
    for (int i = 0; i < count; i++) add_sphere(concentric, Vec3(0.0F), 1.0F + static_cast<float>(i));
    check_both_code_lengths(workshop, std::to_string(count) + " concentric spheres", concentric);
    FlatScene cluster = empty_flat_scene();  // two far ones stretch the grid: all others fall into one cell
    Places places(7);
    add_small_triangle(cluster, Vec3(-1e6F), 1.0F);
    for (int i = 0; i < count; i++) add_small_triangle(cluster, places.in_cube(1e-3F), 1e-3F);
    add_small_triangle(cluster, Vec3(1e6F), 1.0F);
    check_both_code_lengths(workshop, std::to_string(count) + " in one cell", cluster);
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
    check_both_code_lengths(workshop, "planar, axis " + std::to_string(axis), planar);
    check_both_code_lengths(workshop, "centres on a line, axis " + std::to_string(axis), straight);
  }
  FlatScene halving = empty_flat_scene();  // as unbalanced as codes allow
  for (int i = 0; i < 60; i++) add_small_triangle(halving, Vec3(std::exp2(static_cast<float>(-i))), 1e-20F);
  check_both_code_lengths(workshop, "halving distances", halving);
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
  check_both_code_lengths(workshop, "sizes from 2^-100 to 2^100", flat);
  FlatScene tiny = empty_flat_scene();
  for (int i = 0; i < 100; i++) {
    const Vec3 at = 1e-30F * places.direction();
    add_triangle(tiny, at, at + 1e-30F * places.direction(), at + 1e-30F * places.direction());
  }
  check_both_code_lengths(workshop, "all of 1e-30 m", tiny);
  CHECK(test::BuiltTree(workshop, tiny).accel.statistics().primitives == 100);
}

TEST_CASE("what is not finite or has no area is dropped and counted, wherever it stands") {
  test::TreeWorkshop workshop;
  FlatScene only_bad = empty_flat_scene();
  add_bad_primitives(only_bad);
  check_both_code_lengths(workshop, "nothing else", only_bad);
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
  check_both_code_lengths(workshop, "among good ones", mixed);
  const test::BuiltTree mixed_tree(workshop, mixed);
  CHECK(mixed_tree.accel.statistics().primitives == 200);
  CHECK(mixed_tree.accel.statistics().non_finite == 12 * kNonFinite);
  CHECK(mixed_tree.accel.statistics().degenerate == 12 * kDegenerate);
}

TEST_CASE("ten builds of one scene are the same bytes") {
  test::TreeWorkshop workshop;
  const FlatScene flat = soup(20000, 3000, 0.05F, 11);
  std::vector<shared::BvhNode> nodes;
  std::vector<shared::BvhLeaf> leaves;
  for (int build = 0; build < 10; build++) {
    const test::BuiltTree tree(workshop, flat);
    const std::vector<shared::BvhNode> nodes_now = tree.accel.nodes().read();
    const std::vector<shared::BvhLeaf> leaves_now = tree.accel.leaves().read();
    if (build == 0) {
      nodes = nodes_now;
      leaves = leaves_now;
    }
    REQUIRE(nodes_now.size() == nodes.size());
    REQUIRE(leaves_now.size() == leaves.size());
    CHECK(std::memcmp(nodes_now.data(), nodes.data(), nodes.size() * sizeof(nodes[0])) == 0);
    CHECK(std::memcmp(leaves_now.data(), leaves.data(), leaves.size() * sizeof(leaves[0])) == 0);
  }
}

TEST_CASE("the code length follows the number of primitives") {
  test::TreeWorkshop workshop;
  CHECK(test::BuiltTree(workshop, soup(65536, 0, 0.01F, 12)).accel.statistics().morton_bits == 30);
  CHECK(test::BuiltTree(workshop, soup(65536, 1, 0.01F, 12)).accel.statistics().morton_bits == 63);
}

TEST_CASE("a million triangles build a true tree") {
  test::TreeWorkshop workshop;
  const FlatScene flat = soup(1000000, 0, 0.005F, 13);
  const test::BuiltTree tree(workshop, flat);
  CHECK(tree.accel.statistics().morton_bits == 63);
  CHECK(tree.accel.statistics().build_ms > 0.0);
  test::TreeCheck(flat, tree.accel).run(divides_as_host(workshop.context));
}

}  // namespace hemiray
