#include "host/stability/aim.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace hemiray::stability {
namespace {

using bench::Dice;

constexpr float kForever = std::numeric_limits<float>::infinity();

// Half of the values stay as they are.
Vec3 moved_a_little(Vec3 p, Dice& dice) {
  if (dice.one_in(2)) return p;
  for (int axis = 0; axis < 3; axis++) p[axis] = moved_by_ulps(p[axis], static_cast<int>(dice.below(7)) - 3);
  return p;
}

Vec3 pick_origin(const Origins& origins, Dice& dice) {
  if (origins.least == 0.0F) {
    const float x = dice.in(-1, 1), y = dice.in(-1, 1), z = dice.in(-1, 1);
    return origins.center + origins.most * Vec3(x, y, z);
  }
  return origins.center + dice.in(origins.least, origins.most) * any_direction(dice);
}

bool may_start_at(const Origins& origins, Vec3 p) {
  const DVec3 off = DVec3(p) - DVec3(origins.center);
  if (origins.least > 0.0F) return glm::length(off) >= static_cast<double>(origins.least);
  return std::max({std::abs(off.x), std::abs(off.y), std::abs(off.z)}) <= static_cast<double>(origins.most);
}

using Corners = std::array<Vec3, 3>;

// A vertex, a point on a side or hardly beside it, a corner of the box.
DVec3 target_on(const Corners& corner, Dice& dice) {
  const std::uint32_t k = dice.below(3);
  const DVec3 a = corner[k], b = corner[(k + 1) % 3], c = corner[(k + 2) % 3];
  const double along = dice.unit();
  switch (dice.below(8)) {
    case 0:
    case 1:
      return moved_a_little(corner[k], dice);
    case 2:
    case 3:
    case 4:
      return a + along * (b - a);
    case 5:
      return moved_a_little(Vec3(a + along * (b - a)), dice);
    case 6: {
      Vec3 p;
      for (int axis = 0; axis < 3; axis++) {
        const std::array<float, 3> x{corner[0][axis], corner[1][axis], corner[2][axis]};
        p[axis] = dice.one_in(2) ? *std::min_element(x.begin(), x.end()) : *std::max_element(x.begin(), x.end());
      }
      return moved_a_little(p, dice);
    }
    default: {
      const double in = dice.unit() * (dice.one_in(2) ? 0.5 : 1e-6);
      return a + along * (b - a) + in * (c - a) * (1.0 - along);
    }
  }
}

}  // namespace

float moved_by_ulps(float x, int ulps) {
  for (; ulps > 0; ulps--) x = std::nextafter(x, kForever);
  for (; ulps < 0; ulps++) x = std::nextafter(x, -kForever);
  return x;
}

Vec3 any_direction(Dice& dice) {
  for (;;) {
    const float x = dice.in(-1, 1), y = dice.in(-1, 1), z = dice.in(-1, 1);
    const Vec3 p(x, y, z);
    const float length = glm::length(p);
    if (length > 0.1F && length <= 1.0F) return p / length;
  }
}

shared::QueryRay make_ray(Vec3 origin, Vec3 direction) {
  return {{origin.x, origin.y, origin.z, 0.0F}, {direction.x, direction.y, direction.z, kForever}};
}

RayMaker through_first_layer(const FlatScene& flat, DVec3 along, DVec3 middle) {
  return [flat, along, middle](std::uint32_t count, std::uint32_t seed) {
    Dice dice(seed);
    Rays made;
    Vec3 origin(0.0F);
    const auto half = static_cast<std::uint32_t>(flat.triangles.size() / 2);
    while (made.rays.size() < count) {
      if (made.rays.size() % kRaysFromOnePoint == 0) {
        const DVec3 beside = 0.5 * DVec3(any_direction(dice));
        origin = Vec3(middle - along * 1.5 + beside);
      }
      const auto corner = [&](std::uint32_t i) { return DVec3(bench::vertex_of(flat, i)); };
      const shared::uint4 t = flat.triangles[dice.below(half)];
      const DVec3 a = corner(t.x), b = corner(t.y);
      DVec3 target = dice.one_in(3) ? a : a + static_cast<double>(dice.unit()) * (b - a);
      target = middle + 0.7 * (target - middle);  // inner edges are met by chance, vertices not
      made.rays.push_back(make_ray(origin, Vec3(target - DVec3(origin))));
      made.inside.push_back(0);
    }
    return made;
  };
}

RayMaker at_triangles(const FlatScene& flat, std::vector<Origins> origins, std::uint32_t first) {
  std::vector<Corners> targets;
  for (std::size_t i = first; i < flat.triangles.size(); i++) {
    const shared::uint4 t = flat.triangles[i];
    const Corners corner{bench::vertex_of(flat, t.x), bench::vertex_of(flat, t.y), bench::vertex_of(flat, t.z)};
    const auto finite = [](Vec3 p) { return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z); };
    if (std::all_of(corner.begin(), corner.end(), finite)) targets.push_back(corner);
  }
  if (targets.empty()) throw std::logic_error("nothing to aim at");
  return [targets = std::move(targets), origins = std::move(origins)](std::uint32_t count, std::uint32_t seed) {
    Dice dice(seed);
    Rays made;
    made.rays.reserve(count);
    made.inside.reserve(count);
    Vec3 origin;
    int axis = -1;  // of the plane that the group's origin lies in
    for (std::uint32_t i = 0; i < count; i++) {
      const std::uint32_t group = i / kRaysFromOnePoint;
      const Origins& from = origins[group % origins.size()];
      if (i % kRaysFromOnePoint == 0) {
        origin = pick_origin(from, dice);
        axis = -1;
        if (dice.one_in(4)) {
          const int along = static_cast<int>(dice.below(3));
          Vec3 snapped = origin;
          snapped[along] = targets[dice.below(static_cast<std::uint32_t>(targets.size()))][dice.below(3)][along];
          if (may_start_at(from, snapped)) {
            origin = snapped;
            axis = along;
          }
        }
      }
      Vec3 direction(0.0F);
      while (direction == Vec3(0.0F)) {
        const Corners& corner = targets[dice.below(static_cast<std::uint32_t>(targets.size()))];
        direction = Vec3(target_on(corner, dice) - DVec3(origin));
        if (axis >= 0 && dice.one_in(2)) direction[axis] = dice.one_in(2) ? 0.0F : -0.0F;
      }
      made.rays.push_back(make_ray(origin, direction));
      made.inside.push_back(from.inside ? 1 : 0);
    }
    return made;
  };
}

}  // namespace hemiray::stability
