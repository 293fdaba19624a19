// Ray queries: every kind of tree against brute force with the same arithmetic, against double precision, ties, the
// open interval.
#include <catch2/catch.hpp>

#include <cmath>
#include <string>
#include <vector>

#include "tests/bvh/double_oracle.hpp"
#include "tests/bvh/query_bench.hpp"

namespace hemiray {
namespace {

using test::add_plane;
using test::add_sphere;
using test::add_triangle;
using test::aimed_rays;
using test::check_equals_brute_force;
using test::empty_flat_scene;
using test::kMiss;
using test::make_ray;
using test::Places;
using test::QueryBench;
using test::random_rays;
using test::Rays;
using test::soup;

constexpr float kInf = test::kForever;
// Shares of rays that trees of the fast triangle test may answer otherwise than brute force, a few times what was
// seen: fma slabs lose rays at the rim of a box, which is where edges, vertices and flat boxes are; the more the
// farther the scene is from the origin.
constexpr double kSlipsAtRims = 1e-3;
constexpr double kSlipsOfFlatBoxes = 0.03;
constexpr double kSlipsFarAway = 0.3;

}  // namespace

TEST_CASE("every tree finds what brute force finds, on random rays") {
  test::TreeWorkshop workshop;
  check_equals_brute_force(workshop, "triangles", soup(800, 0, 0.2F, 1), random_rays(100000, 4), 0.2);
  check_equals_brute_force(workshop, "spheres", soup(0, 300, 0.2F, 2), random_rays(20000, 4), 0.2);
  check_equals_brute_force(workshop, "both", soup(400, 150, 0.2F, 3), random_rays(20000, 4), 0.2);
  for (const std::uint32_t count : {1U, 2U, 3U, 9U, 17U}) {
    check_equals_brute_force(workshop, std::to_string(count), soup(count, 0, 1.0F, count), random_rays(5000, 4), 0.01);
  }
}

TEST_CASE("every tree finds what brute force finds, with planes and with nothing but planes") {
  test::TreeWorkshop workshop;
  FlatScene flat = soup(300, 100, 0.2F, 5);
  add_plane(flat, {0, -1, 0}, {0, 1, 0});
  add_plane(flat, {0, 0, 0.5F}, glm::normalize(Vec3(1, 2, 3)));
  check_equals_brute_force(workshop, "with planes", flat, random_rays(20000, 6), 0.5);
  FlatScene planes = empty_flat_scene();
  planes.planes = flat.planes;
  check_equals_brute_force(workshop, "planes alone", planes, random_rays(20000, 7), 0.5);
  const FlatScene nothing = empty_flat_scene();
  for (const test::TreeKind& kind : test::tree_kinds()) {
    QueryBench none(workshop, nothing, kind.options);
    CHECK(test::count_found(none.queries.intersect(random_rays(1000, 8))) == 0);
    for (const std::uint32_t o : none.queries.occluded(random_rays(100, 8))) CHECK(o == 0);
    CHECK(none.queries.intersect({}).empty());
  }
}

TEST_CASE("every tree finds what brute force finds, on rays aimed at edges, vertices and box corners") {
  test::TreeWorkshop workshop;
  const FlatScene triangles = soup(800, 0, 0.2F, 9);
  check_equals_brute_force(workshop, "soup", triangles, aimed_rays(triangles, 100000, 10), 0.3, kSlipsAtRims);
  const FlatScene box = test::closed_mesh(6, false, Vec3(0.0F));  // boxes without thickness
  check_equals_brute_force(workshop, "box", box, aimed_rays(box, 100000, 11), 0.5, kSlipsOfFlatBoxes);
  const FlatScene far = test::closed_mesh(6, true, Vec3(100.0F, -50.0F, 70.0F));
  // A ray exactly along an axis is taken as leaving it by 1e-18 (lib/intersect.h): in the plane of a box's end it meets
  // one of two neighbours, and brute force may name the other. Such rays have a case of their own.
  Rays oblique = test::rays_from_inside(far, 50000, 12);
  std::erase_if(oblique, [](const shared::QueryRay& ray) {
    return ray.direction.x == 0.0F || ray.direction.y == 0.0F || ray.direction.z == 0.0F;
  });
  CHECK(oblique.size() > 45000);
  check_equals_brute_force(workshop, "far ball", far, oblique, 0.95, kSlipsFarAway);
}

TEST_CASE("every tree finds what brute force finds within bounded intervals") {
  test::TreeWorkshop workshop;
  const FlatScene flat = soup(400, 100, 0.3F, 13);
  Rays rays = random_rays(50000, 14);
  Places places(15);
  for (shared::QueryRay& ray : rays) {
    ray.origin.w = places.in(0.0F, 1.0F);
    ray.direction.w = ray.origin.w + places.in(0.0F, 1.0F);
  }
  check_equals_brute_force(workshop, "intervals", flat, rays, 0.05);
}

TEST_CASE("trees that are hard to build find what brute force finds") {
  test::TreeWorkshop workshop;
  Places places(30);
  FlatScene planar = empty_flat_scene(), one_cell = empty_flat_scene(), mixed = empty_flat_scene();
  add_triangle(one_cell, Vec3(-1e6F), Vec3(-1e6F, -1e6F, 0), Vec3(-1e6F, 0, -1e6F));
  add_triangle(one_cell, Vec3(1e6F), Vec3(1e6F, 1e6F, 0), Vec3(1e6F, 0, 1e6F));
  for (int i = 0; i < 300; i++) {
    Vec3 a = places.in_cube(1.0F), b = a + 0.3F * places.direction(), c = a + 0.3F * places.direction();
    add_triangle(one_cell, a, b, c);
    const float size = std::exp2(places.in(-12.0F, 3.0F));
    add_triangle(mixed, size * places.direction(), size * places.direction(), size * places.direction());
    a.y = b.y = c.y = 0.25F;
    add_triangle(planar, a, b, c);
  }
  check_equals_brute_force(workshop, "planar", planar, random_rays(20000, 31), 0.2, kSlipsOfFlatBoxes);
  check_equals_brute_force(workshop, "one Morton cell", one_cell, random_rays(20000, 32), 0.2);
  check_equals_brute_force(workshop, "huge and tiny", mixed, random_rays(20000, 33), 0.2);
}

TEST_CASE("a tree so deep that traversal needs more than the usual stack finds what brute force finds") {
  test::TreeWorkshop workshop;
  const FlatScene flat = test::nested_triangles(2000, 34);
  Places places(35);
  Rays rays;
  while (rays.size() < 5000) {  // through the middle, where all boxes lie in each other
    const float size = std::exp2(places.in(-39.0F, 39.0F));
    const Vec3 origin = size * places.in_cube(1.0F);
    rays.push_back(make_ray(origin, glm::normalize(size * 1e-3F * places.in_cube(1.0F) - origin)));
  }
  check_equals_brute_force(workshop, "nested", flat, rays, 0.5);
  unsigned deep = 0;
  for (const test::TreeKind& kind : test::tree_kinds()) {
    const test::BuiltTree tree(workshop, flat, kind.options);
    deep += tree.accel.statistics().stack_depth > 128 ? 1 : 0;
    CHECK(tree.accel.config().stack >= tree.accel.statistics().stack_depth);
  }
  CHECK(deep >= 2);
}

TEST_CASE("the tree agrees with a double precision oracle wherever that is sure") {
  test::TreeWorkshop workshop;
  FlatScene flat = soup(250, 80, 0.3F, 16);
  add_plane(flat, {0, -1.5F, 0}, {0, 1, 0});
  const Rays rays = random_rays(50000, 17);
  for (const std::size_t k : {0U, 1U, 2U, 3U}) {
    const bool strict = k == 0;
    QueryBench bench(workshop, flat, test::tree_kinds()[k].options, strict);
    INFO(test::tree_kinds()[k].name);
    const std::vector<shared::QueryHit> hits = bench.queries.intersect(rays);
    const std::vector<std::uint32_t> occluded = bench.queries.occluded(rays);
    std::size_t sure = 0;
    for (std::size_t i = 0; i < rays.size(); i++) {
      const test::OracleVerdict verdict = test::judge_hit(flat, rays[i], hits[i], occluded[i] != 0);
      INFO("ray " << i << ": " << verdict.objection);
      if (!verdict.objection.empty()) REQUIRE(verdict.objection.empty());
      sure += verdict.sure ? 1 : 0;
    }
    CHECK(static_cast<double>(sure) > 0.95 * static_cast<double>(rays.size()));
  }
}

TEST_CASE("equal distances go to the smaller index, whatever the order in the tree") {
  test::TreeWorkshop workshop;
  FlatScene flat = empty_flat_scene();
  Places places(23);
  // 40 fans of copies; triangle i and i + 40 k are the same. Then spheres that touch a triangle, and a plane.
  std::vector<std::array<Vec3, 3>> shapes;
  for (int i = 0; i < 40; i++) {
    const Vec3 a = places.in_cube(1.0F);
    shapes.push_back({a, a + 0.5F * places.direction(), a + 0.5F * places.direction()});
  }
  for (int copy = 0; copy < 5; copy++) {
    for (const auto& [a, b, c] : shapes) add_triangle(flat, a, b, c);
  }
  for (const test::TreeKind& kind : test::tree_kinds()) {
    INFO(kind.name);
    std::size_t hit = 0;
    for (const shared::QueryHit& h :
         QueryBench(workshop, flat, kind.options).queries.intersect(random_rays(20000, 24))) {
      if (h.primitive == kMiss) continue;
      REQUIRE(h.primitive < 40);
      hit++;
    }
    CHECK(hit > 1000);
  }

  FlatScene touching = empty_flat_scene();  // at (0, 0, 1) all of them
  add_plane(touching, {0, 0, 1}, {0, 0, 1});
  add_sphere(touching, {0, 0, 0}, 1.0F);
  add_sphere(touching, {0, 0, 0}, 1.0F);
  const Rays down = {make_ray({0, 0, 5}, {0, 0, -1})};
  QueryBench without_triangle(workshop, touching);
  CHECK(without_triangle.queries.intersect(down)[0].primitive == 0);
  add_triangle(touching, {-1, -1, 1}, {3, -1, 1}, {-1, 3, 1});
  add_triangle(touching, {-1, -1, 1}, {3, -1, 1}, {-1, 3, 1});
  QueryBench with_triangle(workshop, touching);
  CHECK(with_triangle.queries.intersect(down)[0].primitive == 0);
  CHECK(with_triangle.queries.intersect(down)[0].t == 4.0F);
}

TEST_CASE("hits count in the open interval from t_min to t_max") {
  test::TreeWorkshop workshop;
  const auto check_shape = [&](int kind, const AccelOptions& options) {
    FlatScene flat = empty_flat_scene();
    if (kind == 0) add_triangle(flat, {-1, -1, 1}, {3, -1, 1}, {-1, 3, 1});
    if (kind == 1) add_sphere(flat, {0, 0, 0}, 1.0F);  // hit at 4 and 6
    if (kind == 2) add_plane(flat, {0, 0, 1}, {0, 0, 1});
    QueryBench bench(workshop, flat, options);
    const auto ask = [&](float t_min, float t_max) {
      const Rays rays = {make_ray({0, 0, 5}, {0, 0, -1}, t_min, t_max)};
      const shared::QueryHit hit = bench.queries.intersect(rays)[0];
      const bool occluded = bench.queries.occluded(rays)[0] != 0;
      CHECK(occluded == (hit.primitive != kMiss));
      if (hit.primitive == kMiss) CHECK(hit.t == t_max);
      return hit.primitive == kMiss ? -1.0F : hit.t;
    };
    INFO("kind " << kind);
    const float second = kind == 1 ? 6.0F : -1.0F;  // behind the first hit
    CHECK(ask(0.0F, kInf) == 4.0F);
    CHECK(ask(0.0F, 4.0F) == -1.0F);
    CHECK(ask(0.0F, std::nextafter(4.0F, 5.0F)) == 4.0F);
    CHECK(ask(4.0F, kInf) == second);
    CHECK(ask(std::nextafter(4.0F, 0.0F), kInf) == 4.0F);
    CHECK(ask(4.0F, 6.0F) == -1.0F);
    CHECK(ask(6.0F, kInf) == -1.0F);
    CHECK(ask(5.0F, 5.0F) == -1.0F);
    CHECK(ask(5.0F, 3.0F) == -1.0F);
  };
  for (const test::TreeKind& tree : test::tree_kinds()) {
    INFO(tree.name);
    for (const int kind : {0, 1, 2}) check_shape(kind, tree.options);
  }
}

TEST_CASE("t and the barycentric weights are in the units they promise") {
  test::TreeWorkshop workshop;
  FlatScene flat = empty_flat_scene();
  add_triangle(flat, {0, 0, 1}, {4, 0, 1}, {0, 4, 1});
  for (const test::TreeKind& kind : test::tree_kinds()) {
    QueryBench bench(workshop, flat, kind.options);
    for (const float length : {1e-15F, 0.5F, 1.0F, 3.0F, 1e15F}) {  // any length: t counts in lengths of direction
      const shared::QueryHit hit = bench.queries.intersect(Rays{make_ray({1, 2, 3}, {0, 0, -length})})[0];
      INFO(kind.name << ", length " << length);
      CHECK(hit.primitive == 0);
      CHECK(hit.t == Approx(2.0 / static_cast<double>(length)).epsilon(1e-6));
      CHECK(hit.u == Approx(0.25).epsilon(1e-6));
      CHECK(hit.v == Approx(0.5).epsilon(1e-6));
    }
  }
}

}  // namespace hemiray
