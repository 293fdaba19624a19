#include "host/stability/leaving.hpp"

#include <cmath>

#include "host/bench/flat_mesh.hpp"

namespace hemiray::stability {
namespace {

DVec3 xyz(const shared::float4& v) { return {v.x, v.y, v.z}; }

DVec3 corner_of(const FlatScene& flat, std::uint32_t i) { return bench::vertex_of(flat, i); }

// Of a triangle, not of unit length; of a sphere where the ray, which starts on it, does: outward.
DVec3 normal_of(const FlatScene& flat, std::uint32_t primitive, const DVec3& at) {
  if (primitive >= flat.triangles.size()) {
    return at - xyz(flat.spheres[primitive - flat.triangles.size()].center_radius);
  }
  const shared::uint4 t = flat.triangles[primitive];
  const DVec3 a = corner_of(flat, t.x);
  return glm::cross(corner_of(flat, t.y) - a, corner_of(flat, t.z) - a);
}

// Outside nothing is met; inside the far side, from behind.
void judge_convex(const FlatScene& flat, bool stays_outside, const shared::QueryRay& ray, std::uint32_t left,
                  const shared::QueryHit& next, Tally& tally) {
  const bool found = next.primitive != HR_NO_PRIMITIVE;
  // A direction so flat that by the last bit it goes the other way is nobody's fault.
  const bool goes_out = glm::dot(normal_of(flat, left, xyz(ray.origin)), xyz(ray.direction)) > 0;
  if (goes_out != stays_outside) {
    tally.borderline++;
    return;
  }
  if (stays_outside) {
    tally.self_hit += found ? 1 : 0;
    return;
  }
  if (!found) {
    tally.tunnelled++;
    return;
  }
  const DVec3 d = xyz(ray.direction), o = xyz(ray.origin);
  if (next.primitive < flat.triangles.size()) {
    // From outside: the ray had not been inside.
    tally.self_hit += glm::dot(normal_of(flat, next.primitive, o), d) < 0 ? 1 : 0;
    return;
  }
  // The chord; half of it is far from either end.
  const double chord = -2.0 * glm::dot(normal_of(flat, left, o), d) / glm::dot(d, d);
  tally.self_hit += static_cast<double>(next.t) < 0.5 * chord ? 1 : 0;
}

void judge_layer(const FlatScene& flat, const shared::QueryHit& next, Tally& tally) {
  if (next.primitive == HR_NO_PRIMITIVE) {
    tally.tunnelled++;
  } else if (next.primitive < flat.triangles.size() / 2) {
    tally.self_hit++;
  }
}

}  // namespace

std::vector<shared::float4> wanted_ways(const Rung& rung, const Rays& rays, std::uint32_t seed) {
  bench::Dice dice(seed);
  std::vector<shared::float4> wanted;
  for (const shared::QueryRay& ray : rays.rays) {
    Vec3 way(glm::normalize(xyz(ray.direction)));
    const std::uint32_t kind = dice.below(3);
    float side = kind == 0 ? 1.0F : -1.0F;
    if (rung.after == After::layer) {
      side = -1.0F;
      if (kind == 2) way = glm::normalize(way + 0.3F * any_direction(dice));
    } else if (kind == 2) {
      way = any_direction(dice);
      side = dice.one_in(2) ? 1.0F : -1.0F;
    }
    wanted.push_back({way.x, way.y, way.z, side});
  }
  return wanted;
}

Tally judge_leaving(const Rung& rung, const Rays& rays, const std::vector<shared::float4>& wanted,
                    const LeavingRays& answers) {
  Tally tally;
  for (std::size_t i = 0; i < rays.rays.size(); i++) {
    const shared::QueryHit& hit = answers.hits[i];
    if (hit.primitive == HR_NO_PRIMITIVE) {
      tally.missed += rays.inside[i];
      tally.rays += rays.inside[i];
      continue;
    }
    if (rung.after == After::layer && hit.primitive >= rung.flat.triangles.size() / 2) continue;
    tally.rays++;
    if (rung.after == After::layer) {
      judge_layer(rung.flat, answers.next[i], tally);
    } else {
      const bool outside = (rays.inside[i] == 0) == (wanted[i].w > 0);
      judge_convex(rung.flat, outside, answers.leaving[i], hit.primitive, answers.next[i], tally);
    }
  }
  return tally;
}

}  // namespace hemiray::stability
