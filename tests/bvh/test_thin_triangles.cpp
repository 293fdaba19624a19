// Slivers: how far off t is, and that every kind of tree, single rays and packets agree on it.
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>

#include "host/scene/features.hpp"
#include "tests/bvh/query_bench.hpp"

namespace hemiray {
namespace {

using test::Hits;
using test::Places;
using test::Rays;
using Wide = glm::vec<3, long double>;

// What t may be off by where the triangle is not too thin for its edge functions: 40 HR_THIN_GAIN ulps
// (kernels/lib/thin_triangle.h).
constexpr double kUlps = 2560.0;
constexpr std::size_t kPacket = 64;

// Triangles with a longest side of 1 and a height of 1 / aspect on it, near the origin. `cap`: the third corner is
// above the middle of the longest side, else above its end.
FlatScene slivers(std::uint32_t count, double aspect, bool cap, std::uint32_t seed) {
  FlatScene flat = test::empty_flat_scene();
  Places places(seed);
  for (std::uint32_t i = 0; i < count; i++) {
    const DVec3 along(places.direction()), up = glm::normalize(glm::cross(along, DVec3(places.direction())));
    const DVec3 a(places.in_cube(0.5F));
    test::add_triangle(flat, Vec3(a), Vec3(a + along), Vec3(a + (cap ? 0.4 : 1.0) * along + up / aspect));
  }
  return flat;
}

struct Corners {
  Wide a, b, c;
};

Corners corners(const FlatScene& flat, std::uint32_t triangle) {
  const shared::uint4 t = flat.triangles[triangle];
  return {Wide(test::vertex(flat, t.x)), Wide(test::vertex(flat, t.y)), Wide(test::vertex(flat, t.z))};
}

// At points of the triangles, which they look at from 1 to 3 away, within 70 degrees of the perpendicular.
Rays rays_at(const FlatScene& flat, std::size_t count, std::uint32_t seed) {
  Places places(seed);
  Rays rays;
  Vec3 origin;
  while (rays.size() < count) {
    const Corners at = corners(flat, places.below(static_cast<std::uint32_t>(flat.triangles.size())));
    const float u = places.in(0.0F, 1.0F), v = places.in(0.0F, 1.0F - u);
    if (rays.size() % kPacket == 0) origin = places.in(1.0F, 3.0F) * places.direction();
    const Wide target =
        at.a + static_cast<long double>(u) * (at.b - at.a) + static_cast<long double>(v) * (at.c - at.a);
    rays.push_back(test::make_ray(origin, Vec3(target - Wide(origin))));
  }
  return rays;
}

// How far t is off the triangle's plane [ulps]; 0 where the ray meets it at a small angle.
double ulps_off(const FlatScene& flat, const shared::QueryRay& ray, const shared::QueryHit& hit) {
  const Corners at = corners(flat, hit.primitive);
  const Wide o(ray.origin.x, ray.origin.y, ray.origin.z), d(ray.direction.x, ray.direction.y, ray.direction.z);
  const Wide n = glm::cross(at.b - at.a, at.c - at.a);
  const long double along = glm::dot(n, d);
  if (std::abs(along) < 0.35L * glm::length(n) * glm::length(d)) return 0.0;
  const long double t = glm::dot(n, at.a - o) / along;
  const auto rounded = static_cast<float>(t);
  const double ulp = static_cast<double>(std::nextafter(rounded, test::kForever)) - static_cast<double>(rounded);
  return static_cast<double>(std::abs(static_cast<long double>(hit.t) - t)) / ulp;
}

}  // namespace

TEST_CASE("the distance of a sliver is that of its plane") {
  test::TreeWorkshop workshop;
  for (const bool cap : {false, true}) {
    for (const double aspect : {3.0, 90.0, 1e3, 1e4, 1e5, 1e6}) {
      const FlatScene flat = slivers(200, aspect, cap, 91);
      const Rays rays = rays_at(flat, 20032, 92);
      test::QueryBench bench(workshop, flat);
      const Hits hits = bench.queries.intersect(rays);
      double worst = 0.0;
      for (std::size_t i = 0; i < rays.size(); i++) {
        if (hits[i].primitive != test::kMiss) worst = std::max(worst, ulps_off(flat, rays[i], hits[i]));
      }
      INFO("aspect " << aspect << (cap ? ", caps, " : ", ") << test::count_found(hits) << " hits");
      CHECK(test::count_found(hits) > rays.size() / 20);
      CHECK(worst < kUlps);
    }
  }
}

TEST_CASE("slivers: every kind of tree finds what brute force finds, and packets what single rays find") {
  test::TreeWorkshop workshop;
  FlatScene flat = slivers(150, 1e4, true, 93);
  for (const double aspect : {2.0, 1e3, 1e6}) {
    const FlatScene more = slivers(150, aspect, false, 94);
    for (std::uint32_t i = 0; i < more.triangles.size(); i++) {
      const Corners at = corners(more, i);
      test::add_triangle(flat, Vec3(at.a), Vec3(at.b), Vec3(at.c));
    }
  }
  const Rays rays = rays_at(flat, 20032, 95);
  test::check_equals_brute_force(workshop, "slivers", flat, rays, 0.05, 0.01);
  for (const test::TreeKind& kind : test::tree_kinds()) {
    if (kind.options.explicit_vectors == 0 || kind.options.triangle_test != TriangleTest::watertight) continue;
    INFO(kind.name);
    test::QueryBench bench(workshop, flat, kind.options, false);
    RayQueries packets(workshop.context, bench.tree.scene, bench.tree.accel, false, RayGrouping::packets);
    const Hits hits = packets.intersect(rays);
    CHECK(test::count_different(rays, hits, bench.queries.intersect(rays)) == 0);
    CHECK(test::count_disagreeing(hits, packets.occluded(rays)) == 0);
  }
}

TEST_CASE("only scenes with many thin triangles call for their test") {
  constexpr std::uint32_t kThin = HR_FEATURE_TRIANGLES | HR_FEATURE_THIN_TRIANGLES;
  CHECK(triangle_features(test::empty_flat_scene()) == 0);
  CHECK(triangle_features(slivers(20, 80.0, false, 96)) == HR_FEATURE_TRIANGLES);
  CHECK(triangle_features(slivers(20, 80.0, true, 96)) == HR_FEATURE_TRIANGLES);
  CHECK(triangle_features(slivers(20, 130.0, false, 96)) == kThin);
  CHECK(triangle_features(slivers(20, 130.0, true, 96)) == kThin);
  for (const std::uint32_t thick : {44U, 45U}) {  // beside 3: one in 16
    FlatScene flat = slivers(thick, 80.0, false, 97);
    test::add_triangle(flat, Vec3(0.0F), {1.0F, 0.0F, 0.0F}, {0.0F, 1e-3F, 0.0F});
    test::add_triangle(flat, Vec3(0.0F), {1.0F, 0.0F, 0.0F}, {0.5F, 1e-3F, 0.0F});
    test::add_triangle(flat, Vec3(0.0F), {0.0F, 0.0F, 2.0F}, {0.0F, 1e-3F, 2.0F});
    CHECK(triangle_features(flat) == (thick == 44 ? kThin : HR_FEATURE_TRIANGLES));
  }
}

}  // namespace hemiray
