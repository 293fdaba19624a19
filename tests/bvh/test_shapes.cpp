// Rays against disks, cylinders, cones and quadrics: the source's worked example, a long double oracle on aimed rays at
// all sizes and places, every kind of tree against brute force, closed shapes without gaps.
#include <catch2/catch.hpp>

#include <cmath>
#include <string>
#include <vector>

#include "tests/bvh/shape_rays.hpp"

namespace hemiray {
namespace {

using test::kMiss;
using test::kRayKinds;
using test::make_ray;
using test::NamedShape;
using test::narrow;
using test::Places;
using test::quadric;
using test::QueryBench;
using test::Rays;
using test::rays_at_shape;
using test::rim_point;
using test::scene_of;
using test::ShapeOracle;
using test::shapes_of_size_one;
using test::turned;
using test::Wide;

const char* objection_to(stability::ShapeFault fault) {
  switch (fault) {
    case stability::ShapeFault::off_surface:
      return "the hit is off the surface";
    case stability::ShapeFault::beyond_rim:
      return "the hit is beyond the rim";
    case stability::ShapeFault::before_start:
      return "the hit is not beyond t_min";
    case stability::ShapeFault::missed:
      return "a hit is missed";
    case stability::ShapeFault::not_nearest:
      return "the hit is not the nearest";
    case stability::ShapeFault::none:
      break;
  }
  return "none";
}

void check_against_oracle(test::TreeWorkshop& workshop, const NamedShape& named, const shared::Shape& shape,
                          std::size_t count, std::uint32_t seed) {
  const ShapeOracle oracle(shape);
  const Rays rays = rays_at_shape(shape, count, seed);
  QueryBench bench(workshop, scene_of(shape));
  const test::Hits hits = bench.queries.intersect(rays);
  const std::vector<std::uint32_t> occluded = bench.queries.occluded(rays);
  std::size_t objections = 0, sure = 0, found = 0;
  for (std::size_t i = 0; i < rays.size(); i++) {
    const stability::ShapeVerdict verdict = stability::judge_shapes({&oracle, 1}, 0, rays[i], hits[i]);
    sure += verdict.sure ? 1 : 0;
    found += hits[i].primitive != kMiss ? 1 : 0;
    const bool differs = (occluded[i] != 0) != (hits[i].primitive != kMiss);
    if ((verdict.fault == stability::ShapeFault::none && !differs) || objections++ > 0) continue;
    UNSCOPED_INFO("ray " << i << " of kind " << i % kRayKinds << ": "
                         << (differs ? "occluded() and intersect() differ" : objection_to(verdict.fault)) << ", "
                         << test::describe(rays[i], hits[i], hits[i]) << ", part " << hits[i].u);
  }
  INFO(named.name << ", " << count << " rays, seed " << seed);
  CHECK(objections == 0);
  CHECK(sure > count / 3);
  CHECK(found > count / 20);
}

}  // namespace

TEST_CASE("the source's worked example, by sphere and by quadric, to the last bit") {
  // P = (1, 1, 0), D = (2, 1, 1), a sphere of radius 2: t = (-3 + sqrt 21) / 6.
  test::TreeWorkshop workshop;
  const double root = std::sqrt(21.0);
  const Rays rays = {make_ray({1, 1, 0}, {2, 1, 1})};
  FlatScene by_sphere = test::empty_flat_scene();
  test::add_sphere(by_sphere, {0, 0, 0}, 2.0F);
  for (const FlatScene& flat : {by_sphere, scene_of(flatten_shape(quadric({1, 1, 1, 0, 0, 0, 0, 0, 0, -4})))}) {
    QueryBench bench(workshop, flat);
    const shared::QueryHit hit = bench.queries.intersect(rays)[0];
    REQUIRE(hit.primitive == 0);
    CHECK(hit.t == static_cast<float>((-3.0 + root) / 6.0));
    const auto at = [&](float p, float d) { return std::fma(hit.t, d, p); };
    CHECK(at(1, 2) == static_cast<float>(root / 3.0));
    CHECK(at(1, 1) == static_cast<float>((3.0 + root) / 6.0));
    CHECK(at(0, 1) == static_cast<float>((-3.0 + root) / 6.0));
  }
}

TEST_CASE("shapes are hit where long double says, whatever their size and place: aimed rays") {
  test::TreeWorkshop workshop;
  Places places(77);
  std::uint32_t seed = 100;
  for (const NamedShape& named : shapes_of_size_one()) {
    check_against_oracle(workshop, named, flatten_shape(named.shape), 20000, seed++);
    for (const double size : {1e-3, 1.0, 1e3}) {
      for (const double far : {0.0, 1e3}) {
        NamedShape placed = named;
        placed.name += " of size " + std::to_string(size) + " at " + std::to_string(far);
        const DVec3 place = far * DVec3(places.direction());
        placed.shape.to_world =
            glm::translate(DMat4(1.0), place) * turned(places) * glm::scale(DMat4(1.0), DVec3(size));
        check_against_oracle(workshop, placed, flatten_shape(placed.shape), 4000, seed++);
      }
    }
  }
}

TEST_CASE("shapes are hit where long double says when they are stretched and mirrored") {
  test::TreeWorkshop workshop;
  Places places(78);
  std::uint32_t seed = 500;
  for (NamedShape& named : shapes_of_size_one()) {
    named.shape.to_world = turned(places) * glm::scale(DMat4(1.0), DVec3(0.4, -1.5, 1.0)) * turned(places);
    check_against_oracle(workshop, named, flatten_shape(named.shape), 8000, seed++);
  }
}

TEST_CASE("no ray leaves a closed cone or cylinder from inside, at its rims least of all") {
  test::TreeWorkshop workshop;
  Places places(79);
  for (const NamedShape& named : shapes_of_size_one()) {
    if (named.shape.kind == ShapeKind::disk || named.shape.kind == ShapeKind::quadric || !named.shape.capped) continue;
    for (const double far : {0.0, 1e3}) {
      Shape placed = named.shape;
      placed.to_world = glm::translate(DMat4(1.0), far * DVec3(places.direction())) * turned(places);
      const shared::Shape shape = flatten_shape(placed);
      const ShapeOracle oracle(shape);
      Rays rays;
      for (int i = 0; i < 20000; i++) {
        const long double z = places.in(-0.8F, 0.8F) * shape.form.z;
        const long double across = places.in(0.0F, 0.8F) * (shape.form.x + shape.form.y * z);
        const Vec3 origin = narrow(oracle.world({across, 0, z}));
        // What the float has become must still lie inside.
        const Wide own = oracle.own(Wide(origin));
        if (std::hypot(own.x, own.y) > 0.95L * (shape.form.x + shape.form.y * own.z)) continue;
        const Vec3 target = test::moved_by_ulps(narrow(rim_point(shape, oracle, places)), places);
        rays.push_back(make_ray(origin, target - origin));
      }
      QueryBench bench(workshop, scene_of(shape));
      INFO(named.name << " at " << far);
      REQUIRE(rays.size() > (far > 0.0 && named.name == "wire" ? 10U : 15000U));
      CHECK(rays.size() - test::count_found(bench.queries.intersect(rays)) == 0);
    }
  }
}

namespace {

// Many shapes among triangles and spheres, so that leaves mix them.
FlatScene mixed_scene(std::uint32_t count, std::uint32_t seed) {
  FlatScene flat = test::soup(count, count / 2, 0.2F, seed);
  Places places(seed);
  while (flat.shapes.size() < 2 * std::size_t{count}) {
    for (NamedShape& named : shapes_of_size_one()) {
      const double size = static_cast<double>(places.in(0.02F, 0.2F));
      named.shape.to_world = glm::translate(DMat4(1.0), DVec3(places.in_cube(1.0F))) * turned(places) *
                             glm::scale(DMat4(1.0), DVec3(size));
      flat.shapes.push_back(flatten_shape(named.shape));
    }
  }
  test::add_plane(flat, {0, -1.2F, 0}, {0, 1, 0});
  return flat;
}

Rays rays_at_shapes(const FlatScene& flat, std::size_t count, std::uint32_t seed) {
  Rays rays = test::random_rays(count, seed);
  Places places(seed + 1);
  for (std::size_t i = 0; i < count; i++) {
    const shared::Shape& shape = flat.shapes[places.below(static_cast<std::uint32_t>(flat.shapes.size()))];
    rays.push_back(test::aimed_ray(shape, ShapeOracle(shape), places, static_cast<std::uint32_t>(i) % kRayKinds));
  }
  return rays;
}

}  // namespace

TEST_CASE("every tree finds what brute force finds among shapes, triangles, spheres and planes") {
  test::TreeWorkshop workshop;
  const FlatScene flat = mixed_scene(60, 5);
  test::check_equals_brute_force(workshop, "mixed", flat, rays_at_shapes(flat, 10000, 6), 0.3, 1e-3);
  FlatScene only = test::empty_flat_scene();
  only.shapes = flat.shapes;
  test::check_equals_brute_force(workshop, "only shapes", only, rays_at_shapes(only, 5000, 7), 0.2, 1e-3);
}

TEST_CASE("trees of cells find what brute force finds among shapes, triangles, spheres and planes") {
  test::TreeWorkshop workshop;
  const FlatScene flat = mixed_scene(60, 8);
  const Rays rays = rays_at_shapes(flat, 10000, 9);
  const test::Hits expected = QueryBench(workshop, flat).brute_force(rays);
  for (const char* name : {"octree", "kdtree", "kdtree-median"}) {
    INFO(name);
    QueryBench bench(workshop, flat, parse_accel(name));
    CHECK(test::count_different(rays, bench.queries.intersect(rays), expected) == 0);
    CHECK(test::count_disagreeing(expected, bench.queries.occluded(rays)) == 0);
  }
}

TEST_CASE("packets find what single rays find among shapes") {
  test::TreeWorkshop workshop;
  const FlatScene flat = mixed_scene(60, 10);
  Rays rays;
  Places places(11);
  for (int origin = 0; origin < 20; origin++) {
    const Vec3 from = places.in_cube(2.0F);
    for (int i = 0; i < 256; i++) rays.push_back(make_ray(from, places.in_cube(1.0F) - from));
  }
  const test::BuiltTree tree(workshop, flat);
  RayQueries single(workshop.context, tree.scene, tree.accel, true);
  RayQueries packets(workshop.context, tree.scene, tree.accel, true, RayGrouping::packets);
  CHECK(test::count_different(rays, packets.intersect(rays), single.intersect(rays)) == 0);
  CHECK(packets.occluded(rays) == single.occluded(rays));
}

}  // namespace hemiray
