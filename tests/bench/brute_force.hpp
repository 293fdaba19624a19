// Closest hits by trying every triangle in double precision: the oracle of the benchmark's tests.
#pragma once

#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "host/bench/flat_mesh.hpp"
#include "shared/bvh_types.h"

namespace hemiray::test {

/// Moeller and Trumbore 1997. `sure` is false for rays so near an edge or an end of their interval that rounding
/// decides.
struct BruteForceHit {
  shared::QueryHit hit{0.0F, 0.0F, 0.0F, HR_NO_PRIMITIVE};
  bool sure = true;
};

inline BruteForceHit brute_force_hit(const FlatScene& flat, const shared::QueryRay& ray) {
  constexpr double kMargin = 1e-5;  // barycentric, and relative in t
  const DVec3 origin(ray.origin.x, ray.origin.y, ray.origin.z);
  const DVec3 direction(ray.direction.x, ray.direction.y, ray.direction.z);
  const double t_min = ray.origin.w, t_max = ray.direction.w;
  BruteForceHit found;
  double best = t_max;
  for (std::uint32_t i = 0; i < flat.triangles.size(); i++) {
    const shared::uint4 t = flat.triangles[i];
    const DVec3 a = bench::vertex_of(flat, t.x);
    const DVec3 ab = DVec3(bench::vertex_of(flat, t.y)) - a, ac = DVec3(bench::vertex_of(flat, t.z)) - a;
    const DVec3 p = glm::cross(direction, ac);
    const double determinant = glm::dot(ab, p);
    if (determinant == 0.0) continue;
    const DVec3 s = origin - a, q = glm::cross(s, ab);
    const double u = glm::dot(s, p) / determinant, v = glm::dot(direction, q) / determinant;
    const double distance = glm::dot(ac, q) / determinant;
    const double inside = std::min({u, v, 1.0 - u - v});
    const double margin = kMargin * std::max(1.0, std::abs(distance));
    if (inside < -kMargin || distance < t_min - margin || distance > best + margin) continue;
    if (inside < kMargin || std::abs(distance - t_min) < margin || std::abs(distance - best) < margin) {
      found.sure = false;
    }
    if (inside < 0.0 || distance <= t_min || distance >= best) continue;
    best = distance;
    found.hit = {static_cast<float>(distance), static_cast<float>(u), static_cast<float>(v), i};
  }
  return found;
}

inline std::vector<shared::QueryHit> brute_force_hits(const FlatScene& flat, std::span<const shared::QueryRay> rays) {
  std::vector<shared::QueryHit> hits;
  for (const shared::QueryRay& ray : rays) hits.push_back(brute_force_hit(flat, ray).hit);
  return hits;
}

/// `count` triangles with edges of about a quarter, in [-1, 1]^3.
inline FlatScene triangle_soup(std::uint32_t count, std::uint32_t seed) {
  bench::Dice dice(seed);
  const auto place = [&dice](float half) {
    const float x = dice.in(-half, half), y = dice.in(-half, half), z = dice.in(-half, half);
    return Vec3(x, y, z);
  };
  bench::FlatMesh mesh;
  for (std::uint32_t i = 0; i < count; i++) {
    const Vec3 a = place(1.0F);
    const std::uint32_t first = mesh.vertex(a);
    mesh.vertex(a + place(0.25F));
    mesh.vertex(a + place(0.25F));
    mesh.triangle(first, first + 1, first + 2);
  }
  return std::move(mesh).take();
}

/// Rays into [-1, 1]^3, each 64 consecutive ones from one point outside it; every third interval is short.
inline std::vector<shared::QueryRay> rays_into_soup(std::uint32_t count, std::uint32_t seed) {
  bench::Dice dice(seed);
  const auto place = [&dice](float half) {
    const float x = dice.in(-half, half), y = dice.in(-half, half), z = dice.in(-half, half);
    return Vec3(x, y, z);
  };
  std::vector<shared::QueryRay> rays;
  Vec3 origin(0.0F);
  for (std::uint32_t i = 0; i < count; i++) {
    if (i % 64 == 0) origin = 3.0F * glm::normalize(place(1.0F) + Vec3(1e-3F));
    const Vec3 d = place(1.0F) - origin;
    rays.push_back(
        {{origin.x, origin.y, origin.z, i % 3 == 0 ? 0.5F : 0.0F}, {d.x, d.y, d.z, i % 3 == 0 ? 1.0F : 1e30F}});
  }
  return rays;
}

}  // namespace hemiray::test
