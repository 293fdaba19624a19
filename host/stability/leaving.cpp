#include "host/stability/leaving.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "host/bench/flat_mesh.hpp"

namespace hemiray::stability {
namespace {

DVec3 xyz(const shared::float4& v) { return {v.x, v.y, v.z}; }

bool is_sphere(const FlatScene& flat, std::uint32_t primitive) {
  return primitive >= flat.world_triangles() && primitive - flat.world_triangles() < flat.spheres.size();
}

// Of all, those of instances among them.
std::uint32_t primitive_count(const FlatScene& flat) {
  if (flat.instances.empty()) return static_cast<std::uint32_t>(flat.triangles.size() + flat.spheres.size());
  const shared::Instance& last = flat.instances.back();
  return last.first_id + last.triangle_count;
}

// The corners of a triangle of the world or of an instance, whose transform is exact here but for double's rounding.
std::array<DVec3, 3> corners_of(const FlatScene& flat, std::uint32_t primitive) {
  const auto at = [&flat](std::uint32_t i) { return DVec3(bench::vertex_of(flat, i)); };
  if (primitive < flat.world_triangles()) {
    const shared::uint4 t = flat.triangles[primitive];
    return {at(t.x), at(t.y), at(t.z)};
  }
  const auto is_of = [primitive](const shared::Instance& i) {
    return primitive >= i.first_id && primitive - i.first_id < i.triangle_count;
  };
  const shared::Instance& i = *std::find_if(flat.instances.begin(), flat.instances.end(), is_of);
  const shared::uint4 t = flat.triangles[i.first_triangle + (primitive - i.first_id)];
  const auto to_world = [&i](const DVec3& p) {
    const auto row = [&p](const shared::float4& r) { return glm::dot(xyz(r), p) + static_cast<double>(r.w); };
    return DVec3(row(i.to_world_x), row(i.to_world_y), row(i.to_world_z));
  };
  std::array<DVec3, 3> corners{to_world(at(t.x)), to_world(at(t.y)), to_world(at(t.z))};
  if ((i.flags & HR_INSTANCE_MIRRORED) != 0) std::swap(corners[1], corners[2]);
  return corners;
}

// Of a triangle, not of unit length; of a sphere where the ray, which starts on it, does: outward.
DVec3 normal_of(const FlatScene& flat, std::uint32_t primitive, const DVec3& at) {
  if (is_sphere(flat, primitive)) return at - xyz(flat.spheres[primitive - flat.world_triangles()].center_radius);
  const auto [a, b, c] = corners_of(flat, primitive);
  return glm::cross(b - a, c - a);
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
  if (!is_sphere(flat, next.primitive)) {
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
  } else if (next.primitive < primitive_count(flat) / 2) {
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
    if (rung.after == After::layer && hit.primitive >= primitive_count(rung.flat) / 2) continue;
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
