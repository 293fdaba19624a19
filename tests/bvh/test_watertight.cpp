// Watertightness: no ray leaves a closed mesh between two of its triangles, or between two boxes.
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "tests/bvh/query_bench.hpp"

namespace hemiray {
namespace {

using test::kMiss;
using test::make_ray;
using test::Places;
using test::QueryBench;
using test::Rays;

// The default tree in strict and in fast builds, and every other tree of the watertight test in fast ones.
std::vector<std::pair<AccelOptions, bool>> watertight_trees() {
  std::vector<std::pair<AccelOptions, bool>> trees;
  for (const test::TreeKind& kind : test::tree_kinds()) {
    if (kind.options.triangle_test != TriangleTest::watertight) continue;
    if (trees.empty()) trees.emplace_back(kind.options, true);
    trees.emplace_back(kind.options, false);
  }
  return trees;
}

void check_watertight(const std::string& name, const FlatScene& mesh) {
  test::TreeWorkshop workshop;
  const Rays rays = test::rays_from_inside(mesh, 100000, 21);
  for (const auto& [options, strict] : watertight_trees()) {
    QueryBench bench(workshop, mesh, options, strict);
    const test::Hits hits = bench.queries.intersect(rays);
    const std::vector<std::uint32_t> occluded = bench.queries.occluded(rays);
    INFO(name << ", " << options.width << " wide, " << options.leaf_lanes << " lanes" << (strict ? ", strict" : ""));
    CHECK(rays.size() - test::count_found(hits) == 0);  // leaks
    CHECK(std::count(occluded.begin(), occluded.end(), 0U) == 0);
  }
}

}  // namespace

TEST_CASE("no ray leaves a closed mesh through an edge or a vertex") {
  SECTION("ball") { check_watertight("ball", test::closed_mesh(24, true, Vec3(0.0F))); }
  SECTION("ball moved") { check_watertight("ball moved by 100", test::closed_mesh(24, true, Vec3(100.0F))); }
  SECTION("box") { check_watertight("box", test::closed_mesh(24, false, Vec3(0.0F))); }
  SECTION("box moved") { check_watertight("box moved by 100", test::closed_mesh(24, false, Vec3(100.0F))); }
}

TEST_CASE("no ray along an axis leaves a closed mesh: zeros, negative zeros and denormals in the direction") {
  test::TreeWorkshop workshop;
  Places places(22);
  for (const bool round : {true, false}) {
    const FlatScene mesh = test::closed_mesh(8, round, Vec3(0.0F));  // the planes through 0 hold edges
    Rays rays;
    for (const float small : {0.0F, -0.0F, 1e-45F, -1e-45F, 1e-38F, -1e-38F, 1e-30F, -1e-18F, 2e-18F}) {
      for (int axis = 0; axis < 3; axis++) {
        for (const float sign : {1.0F, -1.0F}) {
          for (int i = 0; i < 200; i++) {
            Vec3 direction(small);
            direction[axis] = sign;
            if (i % 3 == 1) direction[(axis + 1) % 3] = places.in(-1.0F, 1.0F);
            // Every other origin lies on the lattice's planes, where boxes begin and end.
            Vec3 origin = places.in_cube(0.5F);
            if (i % 2 == 0) origin = glm::round(origin * 4.0F) / 4.0F;
            rays.push_back(make_ray(origin, direction));
          }
        }
      }
    }
    for (const auto& [options, strict] : watertight_trees()) {
      QueryBench bench(workshop, mesh, options, strict);
      const std::vector<shared::QueryHit> hits = bench.queries.intersect(rays);
      const std::vector<std::uint32_t> occluded = bench.queries.occluded(rays);
      for (std::size_t i = 0; i < rays.size(); i++) {
        INFO((round ? "ball" : "box") << ", origin " << rays[i].origin.x << ' ' << rays[i].origin.y << ' '
                                      << rays[i].origin.z << ", direction " << rays[i].direction.x << ' '
                                      << rays[i].direction.y << ' ' << rays[i].direction.z);
        REQUIRE(hits[i].primitive != kMiss);
        REQUIRE(occluded[i] == 1);
        REQUIRE(std::isfinite(hits[i].t));
      }
    }
  }
}

TEST_CASE("a ray from very far out, nearly across an axis, meets what it is aimed at") {
  // -origin / direction would leave the range of a float: 1e21 / 1e-18.
  test::TreeWorkshop workshop;
  for (const float far : {1e19F, 1e20F, 1e21F, -1e21F}) {
    FlatScene flat = test::empty_flat_scene();
    const float side = std::abs(far) / 8;
    Rays rays;
    for (int axis = 0; axis < 3; axis++) {
      // Two triangles that reach far along the axis, and rays between them.
      const auto place = [axis](float along, float up, float over) {
        Vec3 p;
        p[axis] = along;
        p[(axis + 1) % 3] = up + 100.0F * static_cast<float>(axis);
        p[(axis + 2) % 3] = over;
        return p;
      };
      for (const float over : {0.0F, 9.0F}) {
        test::add_triangle(flat, place(far - side, -1, over), place(far + side, -1, over), place(far, 2, over));
      }
      for (const float across : {0.0F, -0.0F, 1e-30F, -1e-18F}) {
        for (const float over : {-1.0F, 1.0F}) {
          Vec3 direction(0.0F);
          direction[axis] = across;
          direction[(axis + 2) % 3] = over;
          rays.push_back(make_ray(place(far, 0, 5), direction));
        }
      }
    }
    for (const auto& [options, strict] : watertight_trees()) {
      QueryBench bench(workshop, flat, options, strict);
      const std::vector<shared::QueryHit> hits = bench.queries.intersect(rays);
      for (std::size_t i = 0; i < rays.size(); i++) {
        INFO("at " << far << ", ray " << i << ", " << options.width << " wide");
        CHECK(hits[i].primitive == i / 8 * 2 + i % 2);
      }
    }
  }
}

// Where products of coordinates are rounded by more than a triangle's area, edge functions are 0 by chance.
TEST_CASE("a tiny triangle is not met by rays that pass far from it") {
  test::TreeWorkshop workshop;
  Places places(25);
  FlatScene flat = test::empty_flat_scene();
  std::vector<Vec3> at;
  for (int i = 0; i < 8; i++) {  // in one leaf, whose box hides none of them
    at.push_back(places.in_cube(1.0F));
    const auto corner = [&] { return at.back() + 1e-6F * places.direction(); };
    test::add_triangle(flat, corner(), corner(), corner());
  }
  Rays rays;
  while (rays.size() < 50000) {
    const Vec3 origin = 2.0F * places.direction(), direction = places.direction();
    const auto is_far = [&](Vec3 p) { return glm::length(glm::cross(p - origin, direction)) > 1e-2F; };
    if (std::all_of(at.begin(), at.end(), is_far)) rays.push_back(make_ray(origin, direction));
  }
  for (const auto& [options, strict] : watertight_trees()) {
    QueryBench bench(workshop, flat, options, strict);
    INFO(options.width << " wide, " << options.leaf_lanes << " lanes" << (strict ? ", strict" : ""));
    CHECK(test::count_found(bench.queries.intersect(rays)) == 0);
    CHECK(test::count_found(bench.brute_force(rays)) == 0);
    for (const std::uint32_t met : bench.queries.occluded(rays)) REQUIRE(met == 0);
  }
}

}  // namespace hemiray
