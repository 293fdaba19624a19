// The benchmark's rays: tiles, common origins, pairs, distributions.
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "host/base/error.hpp"
#include "host/bench/ray_sets.hpp"
#include "tests/bench/brute_force.hpp"

namespace hemiray {
namespace {

using bench::RaySet;

constexpr std::uint32_t kResolution = 64;

Vec3 origin_of(const shared::QueryRay& ray) { return {ray.origin.x, ray.origin.y, ray.origin.z}; }
Vec3 direction_of(const shared::QueryRay& ray) { return {ray.direction.x, ray.direction.y, ray.direction.z}; }

// A floor of 64 triangles and a wall, seen from inside; the upper part of the picture misses them.
bench::BenchScene half_open_scene() {
  bench::FlatMesh mesh;
  for (int i = 0; i < 16; i++) {
    const auto x = static_cast<float>(i % 4 - 2), z = static_cast<float>(i / 4 - 2);
    mesh.quad({x, 0, z}, {x, 0, z + 1}, {x + 1, 0, z + 1}, {x + 1, 0, z});
  }
  mesh.quad({-2, 0, -2}, {2, 0, -2}, {2, 1, -2}, {-2, 1, -2});
  bench::BenchScene scene{"half open", std::move(mesh).take(), {}};
  scene.view.eye = {0.1F, 1.0F, 1.5F};
  scene.view.forward = glm::normalize(Vec3(0, -0.3F, -1));
  scene.view.light = {0.5F, 3.0F, 0.2F};
  return scene;
}

std::vector<RaySet> sets_of(const bench::BenchScene& scene) {
  return bench::make_ray_sets(scene, kResolution, [&](std::span<const shared::QueryRay> rays) {
    return test::brute_force_hits(scene.flat, rays);
  });
}

}  // namespace

TEST_CASE("ray sets come in packets of 64 with the origins they promise") {
  const std::vector<RaySet> sets = sets_of(half_open_scene());
  REQUIRE(sets.size() == 5);
  const std::vector<std::string> names{"primary", "shadow", "shadow_from_light", "diffuse", "hemicube"};
  for (std::size_t s = 0; s < sets.size(); s++) {
    const RaySet& set = sets[s];
    INFO(set.name);
    CHECK(set.name == names[s]);
    CHECK(set.any_hit == set.name.starts_with("shadow"));
    CHECK(set.common_origin == (s == 0 || s == 2 || s == 4));
    REQUIRE(set.rays.size() % 64 == 0);
    std::size_t strays = 0;
    for (std::size_t i = 0; i < set.rays.size(); i++) {
      const float length = glm::length(direction_of(set.rays[i]));
      REQUIRE((std::isfinite(length) && length > 0));
      REQUIRE(set.rays[i].origin.w < set.rays[i].direction.w);
      if (origin_of(set.rays[i]) != origin_of(set.rays[i / 64 * 64])) strays++;
    }
    CHECK((strays == 0) == set.common_origin);
  }
  CHECK(sets[0].rays.size() == kResolution * kResolution);
  CHECK(sets[4].rays.size() == std::size_t{8} * 3 * (kResolution / 4) * (kResolution / 4));
}

TEST_CASE("primary rays go through the pixels' centres, in tiles of 4 x 4") {
  const bench::BenchScene scene = half_open_scene();
  const RaySet set = bench::primary_rays(scene.view, kResolution);
  const Vec3 right = glm::normalize(glm::cross(scene.view.forward, Vec3(0, 1, 0)));
  const Vec3 up = glm::cross(right, scene.view.forward);
  for (std::uint32_t i = 0; i < set.rays.size(); i++) {
    const std::uint32_t tile = i / 16, tiles_a_row = kResolution / 4;
    const std::uint32_t column = tile % tiles_a_row * 4 + i % 4, row = tile / tiles_a_row * 4 + i % 16 / 4;
    const Vec3 d = direction_of(set.rays[i]);
    const float depth = glm::dot(d, scene.view.forward);
    const float pixel = 2.0F * 0.8F / kResolution;
    REQUIRE(glm::dot(d, right) / depth == Approx((static_cast<float>(column) + 0.5F) * pixel - 0.8F).margin(1e-4));
    REQUIRE(glm::dot(d, up) / depth == Approx((static_cast<float>(row) + 0.5F) * pixel - 0.8F).margin(1e-4));
    REQUIRE(glm::length(d) == Approx(1.0));
  }
}

TEST_CASE("shadow rays run between the surface and the light, and back as the same pairs") {
  const bench::BenchScene scene = half_open_scene();
  const std::vector<RaySet> sets = sets_of(scene);
  const RaySet &shadow = sets[1], &back = sets[2];
  REQUIRE(shadow.rays.size() == back.rays.size());
  CHECK(shadow.rays.size() < sets[0].rays.size());  // the sky starts none
  CHECK(shadow.rays.size() > sets[0].rays.size() / 2);
  for (std::size_t i = 0; i < shadow.rays.size(); i++) {
    const Vec3 p = origin_of(shadow.rays[i]);
    REQUIRE(std::min(std::abs(p.y), std::abs(p.z + 2)) == Approx(0.001).margin(1e-5));  // off floor or wall
    REQUIRE(glm::distance(p + direction_of(shadow.rays[i]), scene.view.light) < 1e-5F);
    REQUIRE(origin_of(back.rays[i]) == scene.view.light);
    REQUIRE(glm::distance(scene.view.light + direction_of(back.rays[i]), p) < 1e-5F);
    REQUIRE(shadow.rays[i].direction.w < 1.0F);
    REQUIRE(back.rays[i].direction.w < 1.0F);
    REQUIRE(back.rays[i].origin.w > 0.0F);
  }
}

TEST_CASE("diffuse rays are distributed as the cosine") {
  const bench::BenchScene scene = half_open_scene();
  const RaySet diffuse = sets_of(scene)[3];
  double sum = 0.0, sum_of_squares = 0.0;
  for (const shared::QueryRay& ray : diffuse.rays) {
    const bool on_floor = ray.origin.y < 0.002F;
    const double cosine = on_floor ? ray.direction.y : ray.direction.z;
    REQUIRE(cosine > 0.0);
    sum += cosine;
    sum_of_squares += cosine * cosine;
  }
  // E[cos] = 2/3 and E[cos^2] = 1/2 under p = cos / pi; 4 standard errors of a fixed seed.
  const auto n = static_cast<double>(diffuse.rays.size());
  CHECK(sum / n == Approx(2.0 / 3.0).margin(4 * std::sqrt(1.0 / 18.0 / n)));
  CHECK(sum_of_squares / n == Approx(0.5).margin(4 * std::sqrt(1.0 / 12.0 / n)));
}

TEST_CASE("a hemicube's pixels see the whole half space: its form factors add up to 1") {
  constexpr std::uint32_t kSide = kResolution / 4;
  constexpr std::size_t kTop = std::size_t{kSide} * kSide, kAll = 3 * kTop;
  const RaySet set = sets_of(half_open_scene())[4];
  for (std::size_t first = 0; first < set.rays.size(); first += kAll) {
    const Vec3 p = origin_of(set.rays[first]);
    const Vec3 normal = p.y < 0.002F ? Vec3(0, 1, 0) : Vec3(0, 0, 1);
    double sum = 0.0;
    for (std::size_t i = 0; i < kAll; i++) {
      const Vec3 d = direction_of(set.rays[first + i]);
      REQUIRE(glm::dot(d, normal) > 0.0F);
      // The face's own axis is the largest component but that of the half sides' height, which is at most as large.
      Vec3 face = normal;
      if (i >= kTop) {
        Vec3 flat_part = d - glm::dot(d, normal) * normal;
        const int axis = std::abs(flat_part.x) >= std::max(std::abs(flat_part.y), std::abs(flat_part.z)) ? 0
                         : std::abs(flat_part.y) >= std::abs(flat_part.z)                                ? 1
                                                                                                         : 2;
        face = Vec3(0.0F);
        face[axis] = flat_part[axis] > 0 ? 1.0F : -1.0F;
      }
      const double toward = glm::dot(d, face);
      sum += glm::dot(d, normal) * std::pow(toward, 3) * 4.0 / (kSide * kSide) / std::numbers::pi;
    }
    CHECK(sum == Approx(1.0).margin(0.01));  // midpoint rule over 768 pixels
  }
}

TEST_CASE("ray sets refuse what they cannot be made of") {
  bench::BenchScene scene = half_open_scene();
  const auto hits = [&](std::span<const shared::QueryRay> rays) { return test::brute_force_hits(scene.flat, rays); };
  CHECK_THROWS_AS(bench::make_ray_sets(scene, 0, hits), InputError);
  CHECK_THROWS_AS(bench::make_ray_sets(scene, 48, hits), InputError);
  CHECK_THROWS_AS(bench::make_ray_sets(scene, 8192, hits), InputError);
  scene.view.forward = {0, 1, 0};  // the sky; also the one direction that is parallel to up
  CHECK_THROWS_WITH(bench::make_ray_sets(scene, 32, hits), Catch::Contains("half open") && Catch::Contains("camera"));
}

}  // namespace hemiray
