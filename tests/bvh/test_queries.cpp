// Ray queries: the tree against brute force with the same arithmetic and against double precision, watertightness,
// ties, the open interval.
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include "tests/bvh/double_oracle.hpp"
#include "tests/bvh/flat_shapes.hpp"
#include "tests/support/kernel_folder.hpp"

namespace hemiray {
namespace {

using test::add_plane;
using test::add_sphere;
using test::add_triangle;
using test::empty_flat_scene;
using test::Places;
using test::soup;
using test::vertex;
using Rays = std::vector<shared::QueryRay>;

constexpr float kInf = std::numeric_limits<float>::infinity();
constexpr std::uint32_t kMiss = HR_NO_PRIMITIVE;

shared::QueryRay make_ray(Vec3 origin, Vec3 direction, float t_min = 0.0F, float t_max = kInf) {
  return {{origin.x, origin.y, origin.z, t_min}, {direction.x, direction.y, direction.z, t_max}};
}

float moved_by_ulps(float x, int ulps) {
  for (; ulps > 0; ulps--) x = std::nextafter(x, kInf);
  for (; ulps < 0; ulps++) x = std::nextafter(x, -kInf);
  return x;
}

Vec3 moved_by_ulps(Vec3 p, Places& places) {
  const auto some = [&] { return static_cast<int>(places.below(7)) - 3; };
  return {moved_by_ulps(p.x, some()), moved_by_ulps(p.y, some()), moved_by_ulps(p.z, some())};
}

// All leaves in turn with the kernels' own intersection functions, no boxes: what the tree must find, bit for bit in a
// strict build.
constexpr const char* kBruteForce = R"(#include "lib/traverse.h"
kernel void brute_intersect(HR_SCENE_PARAMETERS global const QueryRay* restrict rays, global QueryHit* restrict hits,
                            const uint leaf_count, const RenderParams params) {
  const uint i = (uint)get_global_id(0);
  HR_MAKE_SCENE_VIEW(params)
  const QueryRay q = rays[i];
  const Ray ray = make_ray((real3)(q.origin.x, q.origin.y, q.origin.z),
                           (real3)(q.direction.x, q.direction.y, q.direction.z), q.origin.w, q.direction.w);
  const Skip skip = {HR_NO_PRIMITIVE, 1, 0};
  Hit best, candidate;
  best.t = ray.t_max;
  best.u = 0;
  best.v = 0;
  best.primitive = HR_NO_PRIMITIVE;
  for (uint k = 0; k < leaf_count + view.plane_count; k++) {
    const bool met = k < leaf_count ? intersect_leaf(&view, &ray, k, &skip, &candidate)
                                    : intersect_plane_primitive(&view, &ray, k - leaf_count, &skip, &candidate);
    if (!met || !(candidate.t < ray.t_max)) continue;
    if (candidate.t < best.t || (candidate.t == best.t && candidate.primitive < best.primitive)) best = candidate;
  }
  QueryHit result;
  result.t = (float)best.t;
  result.u = (float)best.u;
  result.v = (float)best.v;
  result.primitive = best.primitive;
  hits[i] = result;
}
)";

// One scene, its tree, its queries and the brute force beside them.
class QueryBench {
 public:
  QueryBench(test::TreeWorkshop& workshop, const FlatScene& flat, bool strict = true)
      : workshop_(workshop),
        flat_(flat),
        tree_(workshop, flat),
        queries(workshop.context, tree_.scene, tree_.accel, strict) {}

  std::vector<shared::QueryHit> brute_force(const Rays& rays) {
    const test::KernelFolder folder("probe/brute.cl", kBruteForce);
    Program program(workshop_.context, "brute", {"probe/brute.cl"}, {test::kAllPrimitives, true});
    const Buffer<shared::QueryRay> device_rays(workshop_.context, "rays", std::span<const shared::QueryRay>(rays));
    const Buffer<shared::QueryHit> hits(workshop_.context, "hits", rays.size());
    shared::RenderParams params{};
    params.triangle_count = tree_.scene.triangle_count();
    params.sphere_count = tree_.scene.sphere_count();
    params.plane_count = tree_.scene.plane_count();
    launch(workshop_.context, program.kernel("brute_intersect"), rays.size(),
           arguments(tree_.scene.shading_arguments(), tree_.accel.tree_arguments(), arg("rays", device_rays),
                     arg("hits", hits), arg("leaf_count", tree_.accel.statistics().primitives), arg("params", params)));
    return hits.read();
  }

  // The tree finds what brute force finds, to the bit, and occluded() agrees with intersect().
  void check_equals_brute_force(const std::string& name, const Rays& rays, double least_hit_share) {
    INFO(name << ", " << rays.size() << " rays");
    const std::vector<shared::QueryHit> expected = brute_force(rays);
    const std::vector<shared::QueryHit> hits = queries.intersect(rays);
    const std::vector<std::uint32_t> occluded = queries.occluded(rays);
    REQUIRE(hits.size() == rays.size());
    REQUIRE(occluded.size() == rays.size());
    std::size_t found = 0;
    for (std::size_t i = 0; i < rays.size(); i++) {
      INFO("ray " << i << ": origin " << rays[i].origin.x << ' ' << rays[i].origin.y << ' ' << rays[i].origin.z
                  << " direction " << rays[i].direction.x << ' ' << rays[i].direction.y << ' ' << rays[i].direction.z
                  << "; t " << hits[i].t << " primitive " << hits[i].primitive << ", expected " << expected[i].t << ' '
                  << expected[i].primitive);
      const bool equal = std::memcmp(&hits[i], &expected[i], sizeof hits[i]) == 0;
      const bool agrees = occluded[i] == (expected[i].primitive != kMiss ? 1U : 0U);
      if (!equal || !agrees) {
        REQUIRE(equal);
        REQUIRE(agrees);
      }
      found += expected[i].primitive != kMiss;
    }
    CHECK(static_cast<double>(found) >= least_hit_share * static_cast<double>(rays.size()));
  }

 private:
  test::TreeWorkshop& workshop_;
  const FlatScene& flat_;
  test::BuiltTree tree_;

 public:
  RayQueries queries;
};

Rays random_rays(std::size_t count, std::uint32_t seed, float from = 2.0F) {
  Places places(seed);
  Rays rays;
  while (rays.size() < count) {
    const Vec3 origin = places.in_cube(from);
    rays.push_back(make_ray(origin, rays.size() % 2 == 0 ? places.direction() : places.in_cube(1.0F) - origin));
  }
  return rays;
}

// From random places to vertices, to points of edges and to the planes of triangles' boxes, give or take 3 ulps.
Rays aimed_rays(const FlatScene& flat, std::size_t count, std::uint32_t seed) {
  Places places(seed);
  Rays rays;
  while (rays.size() < count) {
    const shared::uint4 t = flat.triangles[places.below(static_cast<std::uint32_t>(flat.triangles.size()))];
    const Vec3 a = vertex(flat, t.x), b = vertex(flat, t.y), c = vertex(flat, t.z);
    const Vec3 origin = places.in_cube(2.0F);
    Vec3 target = a;
    if (rays.size() % 3 == 1) target = a + places.in(0.0F, 1.0F) * (b - a);
    if (rays.size() % 3 == 2) {  // through a corner of the box
      target = {std::min({a.x, b.x, c.x}), std::max({a.y, b.y, c.y}), std::min({a.z, b.z, c.z})};
    }
    target = moved_by_ulps(target, places);
    rays.push_back(make_ray(origin, target - origin));
  }
  return rays;
}

Vec3 centre_of(const FlatScene& mesh) {
  DVec3 sum(0.0);
  for (std::uint32_t i = 0; i < mesh.positions.size() / 3; i++) sum += DVec3(vertex(mesh, i));
  return Vec3(sum / static_cast<double>(mesh.positions.size() / 3));
}

// From inside a closed mesh, straight at its vertices and at points of its edges.
Rays rays_from_inside(const FlatScene& mesh, std::size_t count, std::uint32_t seed) {
  Places places(seed);
  const Vec3 centre = centre_of(mesh);
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

void check_watertight(const std::string& name, const FlatScene& mesh) {
  test::TreeWorkshop workshop;
  const Rays rays = rays_from_inside(mesh, 100000, 21);
  for (const bool strict : {true, false}) {
    QueryBench bench(workshop, mesh, strict);
    const std::vector<shared::QueryHit> hits = bench.queries.intersect(rays);
    const std::vector<std::uint32_t> occluded = bench.queries.occluded(rays);
    std::size_t leaks = 0, shadow_leaks = 0;
    for (std::size_t i = 0; i < rays.size(); i++) {
      leaks += hits[i].primitive == kMiss;
      shadow_leaks += occluded[i] == 0;
    }
    INFO(name << (strict ? ", strict" : ", fast"));
    CHECK(leaks == 0);
    CHECK(shadow_leaks == 0);
  }
}

}  // namespace

TEST_CASE("the tree finds what brute force finds, on random rays") {
  test::TreeWorkshop workshop;
  for (const auto& [name, flat] : {std::pair<std::string, FlatScene>{"triangles", soup(800, 0, 0.2F, 1)},
                                   {"spheres", soup(0, 300, 0.2F, 2)},
                                   {"both", soup(400, 150, 0.2F, 3)}}) {
    QueryBench(workshop, flat).check_equals_brute_force(name, random_rays(100000, 4), 0.2);
  }
}

TEST_CASE("the tree finds what brute force finds, with planes and with nothing but planes") {
  test::TreeWorkshop workshop;
  FlatScene flat = soup(300, 100, 0.2F, 5);
  add_plane(flat, {0, -1, 0}, {0, 1, 0});
  add_plane(flat, {0, 0, 0.5F}, glm::normalize(Vec3(1, 2, 3)));
  QueryBench(workshop, flat).check_equals_brute_force("with planes", random_rays(50000, 6), 0.5);
  FlatScene planes = empty_flat_scene();
  planes.planes = flat.planes;
  QueryBench(workshop, planes).check_equals_brute_force("planes alone", random_rays(50000, 7), 0.5);
  const FlatScene nothing = empty_flat_scene();
  QueryBench none(workshop, nothing);
  for (const shared::QueryHit& hit : none.queries.intersect(random_rays(1000, 8))) CHECK(hit.primitive == kMiss);
  for (const std::uint32_t o : none.queries.occluded(random_rays(1000, 8))) CHECK(o == 0);
  CHECK(none.queries.intersect({}).empty());
}

TEST_CASE("the tree finds what brute force finds, on rays aimed at edges, vertices and box corners") {
  test::TreeWorkshop workshop;
  const FlatScene triangles = soup(800, 0, 0.2F, 9);
  QueryBench(workshop, triangles).check_equals_brute_force("soup", aimed_rays(triangles, 100000, 10), 0.3);
  const FlatScene box = test::closed_mesh(6, false, Vec3(0.0F));  // boxes without thickness
  QueryBench(workshop, box).check_equals_brute_force("box", aimed_rays(box, 100000, 11), 0.5);
  const FlatScene far = test::closed_mesh(6, true, Vec3(100.0F, -50.0F, 70.0F));
  // A ray exactly along an axis is taken as leaving it by 1e-18 (lib/intersect.h): in the plane of a box's end it meets
  // one of two neighbours, and brute force may name the other. Such rays have a case of their own below.
  Rays oblique = rays_from_inside(far, 100000, 12);
  std::erase_if(oblique, [](const shared::QueryRay& ray) {
    return ray.direction.x == 0.0F || ray.direction.y == 0.0F || ray.direction.z == 0.0F;
  });
  CHECK(oblique.size() > 90000);
  QueryBench(workshop, far).check_equals_brute_force("far ball", oblique, 1.0);
}

TEST_CASE("the tree finds what brute force finds within bounded intervals") {
  test::TreeWorkshop workshop;
  const FlatScene flat = soup(400, 100, 0.3F, 13);
  Rays rays = random_rays(100000, 14);
  Places places(15);
  for (shared::QueryRay& ray : rays) {
    ray.origin.w = places.in(0.0F, 1.0F);
    ray.direction.w = ray.origin.w + places.in(0.0F, 1.0F);
  }
  QueryBench(workshop, flat).check_equals_brute_force("intervals", rays, 0.05);
}

TEST_CASE("the tree agrees with a double precision oracle wherever that is sure") {
  test::TreeWorkshop workshop;
  FlatScene flat = soup(250, 80, 0.3F, 16);
  add_plane(flat, {0, -1.5F, 0}, {0, 1, 0});
  const Rays rays = random_rays(100000, 17);
  for (const bool strict : {true, false}) {
    QueryBench bench(workshop, flat, strict);
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
    for (const bool strict : {true, false}) {
      QueryBench bench(workshop, mesh, strict);
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
  std::size_t hit = 0;
  for (const shared::QueryHit& h : QueryBench(workshop, flat).queries.intersect(random_rays(20000, 24))) {
    if (h.primitive == kMiss) continue;
    REQUIRE(h.primitive < 40);
    hit++;
  }
  CHECK(hit > 1000);

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
  for (const int kind : {0, 1, 2}) {
    FlatScene flat = empty_flat_scene();
    if (kind == 0) add_triangle(flat, {-1, -1, 1}, {3, -1, 1}, {-1, 3, 1});
    if (kind == 1) add_sphere(flat, {0, 0, 0}, 1.0F);  // hit at 4 and 6
    if (kind == 2) add_plane(flat, {0, 0, 1}, {0, 0, 1});
    QueryBench bench(workshop, flat);
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
  }
}

TEST_CASE("t and the barycentric weights are in the units they promise") {
  test::TreeWorkshop workshop;
  FlatScene flat = empty_flat_scene();
  add_triangle(flat, {0, 0, 1}, {4, 0, 1}, {0, 4, 1});
  QueryBench bench(workshop, flat);
  for (const float length : {1e-15F, 0.5F, 1.0F, 3.0F, 1e15F}) {  // any length: t counts in lengths of direction
    const shared::QueryHit hit = bench.queries.intersect(Rays{make_ray({1, 2, 3}, {0, 0, -length})})[0];
    INFO("length " << length);
    CHECK(hit.primitive == 0);
    CHECK(hit.t == Approx(2.0 / static_cast<double>(length)).epsilon(1e-6));
    CHECK(hit.u == Approx(0.25).epsilon(1e-6));
    CHECK(hit.v == Approx(0.5).epsilon(1e-6));
  }
}

}  // namespace hemiray
