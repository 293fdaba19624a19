// A double precision oracle of ray queries that knows where it is sure.
#pragma once

#include <cmath>
#include <limits>
#include <optional>
#include <string>

#include "tests/bvh/flat_shapes.hpp"

namespace hemiray::test {

/// One primitive against one ray, in double.
struct OracleHit {
  bool possible = false;  ///< float may see a hit here
  bool certain = false;   ///< float must see a hit here
  double t = 0.0;
};

/// An outcome nearer to its threshold than this (relative to the lengths at hand) is not sure: a few hundred float ulps
/// of coordinates of magnitude 2, on triangles whose least height is a hundredth of their edges.
inline constexpr double kUnsure = 1e-4;
/// Distances agree to this: float's error over what is sure.
inline constexpr double kDistance = 2e-5;

inline OracleHit oracle_triangle(const FlatScene& flat, std::uint32_t i, const DVec3& o, const DVec3& d) {
  const shared::uint4 index = flat.triangles[i];
  const DVec3 a = vertex(flat, index.x), b = vertex(flat, index.y), c = vertex(flat, index.z);
  const DVec3 e1 = b - a, e2 = c - a, n = glm::cross(e1, e2);
  const double facing = glm::dot(n, d);
  const double steepness = std::abs(facing) / (glm::length(n) * glm::length(d));
  if (facing == 0.0) return {};
  OracleHit hit;
  hit.t = glm::dot(n, a - o) / facing;
  const DVec3 p = o + hit.t * d - a;
  const double u = glm::dot(glm::cross(p, e2), n) / glm::dot(n, n);
  const double v = glm::dot(glm::cross(e1, p), n) / glm::dot(n, n);
  const double margin = std::min({u, v, 1.0 - u - v});
  // The steeper the ray and the fatter the triangle, the better float knows where it passes.
  const double fatness = glm::length(n) / (glm::length(e1) * glm::length(e2));
  const double unsure = kUnsure / (std::max(steepness, 1e-9) * std::max(fatness, 1e-9));
  hit.possible = margin > -unsure;
  hit.certain = margin > unsure && unsure < 0.1;
  return hit;
}

inline OracleHit oracle_sphere(const FlatScene& flat, std::size_t i, const DVec3& o, const DVec3& d) {
  const shared::float4 s = flat.spheres[i].center_radius;
  const DVec3 oc = o - DVec3(s.x, s.y, s.z);
  const double radius = s.w, dd = glm::dot(d, d), b = -glm::dot(oc, d);
  const double distance = glm::length(oc + d * (b / dd)) / radius;
  OracleHit hit;
  const double root = std::sqrt(std::max(dd * (radius * radius - glm::dot(oc + d * (b / dd), oc + d * (b / dd))), 0.0));
  const double near_t = (b - root) / dd, far_t = (b + root) / dd;
  const double edge = kUnsure * radius / std::sqrt(dd);
  hit.t = near_t > 0.0 ? near_t : far_t;
  hit.possible = distance < 1.0 + kUnsure && far_t > -edge;
  hit.certain = distance < 1.0 - kUnsure && far_t > edge && std::abs(near_t) > edge;
  return hit;
}

inline OracleHit oracle_plane(const FlatScene& flat, std::size_t i, const DVec3& o, const DVec3& d) {
  const shared::Plane& plane = flat.planes[i];
  const DVec3 n(plane.normal.x, plane.normal.y, plane.normal.z), p(plane.point.x, plane.point.y, plane.point.z);
  const double facing = glm::dot(n, d);
  if (facing == 0.0) return {};
  return {true, std::abs(facing) > kUnsure * glm::length(d), glm::dot(n, p - o) / facing};
}

inline OracleHit oracle_hit(const FlatScene& flat, std::uint32_t primitive, const DVec3& o, const DVec3& d) {
  const std::size_t triangles = flat.triangles.size(), spheres = flat.spheres.size();
  OracleHit hit = primitive < triangles             ? oracle_triangle(flat, primitive, o, d)
                  : primitive < triangles + spheres ? oracle_sphere(flat, primitive - triangles, o, d)
                                                    : oracle_plane(flat, primitive - triangles - spheres, o, d);
  const double reach = kUnsure / glm::length(d);  // a hit this near to the origin may be before or behind it
  hit.possible = hit.possible && hit.t > -reach;
  hit.certain = hit.certain && hit.t > reach;
  return hit;
}

struct OracleVerdict {
  std::string objection;  ///< empty if the answer can be right
  bool sure = false;      ///< only one answer could have been right
};

/// Judges the answers to one ray from t = 0 on without end.
inline OracleVerdict judge_hit(const FlatScene& flat, const shared::QueryRay& ray, const shared::QueryHit& answer,
                               bool occluded) {
  const DVec3 o(ray.origin.x, ray.origin.y, ray.origin.z), d(ray.direction.x, ray.direction.y, ray.direction.z);
  double nearest = std::numeric_limits<double>::infinity();  // of the certain hits
  std::uint32_t nearest_primitive = HR_NO_PRIMITIVE;
  double nearest_possible = nearest;
  std::optional<OracleHit> answered;
  const auto count = static_cast<std::uint32_t>(flat.triangles.size() + flat.spheres.size() + flat.planes.size());
  for (std::uint32_t i = 0; i < count; i++) {
    const OracleHit hit = oracle_hit(flat, i, o, d);
    if (i == answer.primitive) answered = hit;
    if (hit.certain && hit.t < nearest) {
      nearest = hit.t;
      nearest_primitive = i;
    }
    if (hit.possible && !hit.certain) nearest_possible = std::min(nearest_possible, hit.t);
  }
  const bool found = answer.primitive != HR_NO_PRIMITIVE;
  const std::string what = "primitive " + std::to_string(answer.primitive) + " at " + std::to_string(answer.t) +
                           "; double: " + std::to_string(nearest_primitive) + " at " + std::to_string(nearest);
  if (occluded != found) return {"occluded() and intersect() differ, " + what, false};
  if (!found) {
    if (std::isfinite(nearest)) return {"missed a hit, " + what, false};
    return {"", !std::isfinite(nearest_possible)};
  }
  if (!answered || !answered->possible) return {"hit what cannot be hit, " + what, false};
  const double tolerance = kDistance * (1.0 + std::abs(answered->t)) + kUnsure * (answered->certain ? 0.0 : 100.0);
  if (std::abs(static_cast<double>(answer.t) - answered->t) > tolerance) return {"wrong distance, " + what, false};
  if (static_cast<double>(answer.t) > nearest * (1.0 + kDistance) + kDistance)
    return {"not the nearest, " + what, false};
  return {"", answered->certain && answer.primitive == nearest_primitive && nearest_possible > nearest};
}

}  // namespace hemiray::test
