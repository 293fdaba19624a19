// Spheres: far away, small and large, and touched by rays.
#include <cmath>
#include <utility>

#include "host/stability/rung.hpp"

namespace hemiray::stability {
namespace {

using bench::Dice;

FlatScene one_sphere(float radius, Vec3 center = Vec3(0.0F)) {
  FlatScene flat = bench::FlatMesh().take();
  shared::Sphere sphere{};
  sphere.center_radius = {center.x, center.y, center.z, radius};
  flat.spheres.push_back(sphere);
  return flat;
}

// Passes the centre, at the origin, at `beside` radii, from a distance of `from`: along an axis, so that the ray can be
// written down, or anyhow.
shared::QueryRay passing(double radius, double beside, double from, Dice& dice) {
  DVec3 along(0.0), across(0.0);
  if (dice.one_in(2)) {
    const int axis = static_cast<int>(dice.below(3));
    along[axis] = dice.one_in(2) ? 1.0 : -1.0;
    across[(axis + 1) % 3] = 0.6;
    across[(axis + 2) % 3] = 0.8;
  } else {
    along = glm::normalize(DVec3(any_direction(dice)));
    across = glm::normalize(glm::cross(along, DVec3(any_direction(dice))));
  }
  return make_ray(Vec3(across * (beside * radius) - along * from), Vec3(along));
}

Rung far_rung(std::string name, double radius) {
  Rung rung;
  rung.name = std::move(name);
  rung.flat = one_sphere(static_cast<float>(radius));
  rung.rays = [radius](std::uint32_t count, std::uint32_t seed) {
    Dice dice(seed);
    Rays made;
    for (std::uint32_t i = 0; i < count; i++) {
      // Half anywhere, half near the rim.
      const double beside =
          dice.one_in(2) ? dice.in(0.0F, 1.5F) : 1.0 + dice.in(-1.0F, 1.0F) * std::pow(10.0, -1.0 - dice.below(6));
      made.rays.push_back(passing(radius, beside, 1e6 + radius, dice));
      made.inside.push_back(0);
    }
    return made;
  };
  return rung;
}

Rung tangent_rung(std::string name, double off) {
  Rung rung;
  rung.name = std::move(name);
  rung.flat = one_sphere(1.0F);
  rung.rays = [off](std::uint32_t count, std::uint32_t seed) {
    Dice dice(seed);
    Rays made;
    for (std::uint32_t i = 0; i < count; i++) {
      const double beside = 1.0 + (dice.one_in(2) ? off : -off) * dice.in(0.5F, 1.0F);
      made.rays.push_back(passing(1.0, beside, dice.in(2.0F, 4.0F), dice));
      made.inside.push_back(0);
    }
    return made;
  };
  return rung;
}

}  // namespace

std::vector<Case> sphere_cases() {
  Case far{"far sphere", "A sphere of that radius from 1e6 away, rays anywhere and near the rim.", {}};
  constexpr std::pair<const char*, double> kRadii[] = {{"1e6", 1e6}, {"1e4", 1e4},   {"1e2", 1e2},
                                                       {"1", 1.0},   {"1e-1", 1e-1}, {"1e-3", 1e-3}};
  for (const auto& [name, value] : kRadii) far.rungs.emplace_back([=] { return far_rung(name, value); });

  Case tangent{"tangent", "A unit sphere passed within that of touching, from 2 to 4 away.", {}};
  constexpr std::pair<const char*, double> kOff[] = {{"1e-1", 1e-1}, {"1e-2", 1e-2}, {"1e-3", 1e-3}, {"1e-4", 1e-4},
                                                     {"1e-5", 1e-5}, {"1e-6", 1e-6}, {"1e-7", 1e-7}};
  for (const auto& [name, value] : kOff) tangent.rungs.emplace_back([=] { return tangent_rung(name, value); });
  return {std::move(far), std::move(tangent)};
}

}  // namespace hemiray::stability
