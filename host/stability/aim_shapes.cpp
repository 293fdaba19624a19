#include "host/stability/aim_shapes.hpp"

#include <cmath>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "host/stability/shape_oracle.hpp"

namespace hemiray::stability {
namespace {

using bench::Dice;

struct Target {
  shared::Shape shape;
  ShapeOracle oracle;
};

struct SurfacePoint {
  Wide p, normal;
};

Wide direction(Dice& dice) { return glm::normalize(Wide(any_direction(dice))); }

Wide in_cube(Dice& dice, float half_side) {
  const float x = dice.in(-half_side, half_side), y = dice.in(-half_side, half_side),
              z = dice.in(-half_side, half_side);
  return {x, y, z};
}

SurfacePoint any_point(const Target& target, Dice& dice) {
  const ShapeOracle& oracle = target.oracle;
  for (int attempt = 0; attempt < 10000; attempt++) {
    const Wide from = oracle.place() + oracle.reach() * in_cube(dice, 0.7F);
    const Wide d = attempt % 2 == 0 ? direction(dice) : glm::normalize(oracle.place() - from);
    const auto hits = oracle.hits(from, d, 0);
    if (hits.empty()) continue;
    const SurfaceHit hit = hits[dice.below(static_cast<std::uint32_t>(hits.size()))];
    const Wide p = from + d * hit.t;
    return {p, oracle.normal(hit.part, p)};
  }
  throw std::logic_error("a shape that no ray meets");
}

// Of the rim of a disk, the edge between side and caps, or an apex; of a quadric any point.
Wide rim_point(const Target& target, Dice& dice) {
  const shared::Shape& s = target.shape;
  if (s.kind == HR_SHAPE_QUADRIC) return any_point(target, dice).p;
  const long double turn = 2 * std::numbers::pi_v<long double> * static_cast<long double>(dice.unit());
  long double z = 0, radius = s.form.x;
  if (s.kind == HR_SHAPE_CONE) {
    z = dice.one_in(2) ? s.form.z : -s.form.z;
    radius = s.form.x + s.form.y * z;
  }
  return target.oracle.world({radius * std::cos(turn), radius * std::sin(turn), z});
}

Vec3 a_little_off(const Wide& p, Dice& dice) {
  Vec3 moved(p);
  if (dice.one_in(2)) return moved;
  for (int axis = 0; axis < 3; axis++) {
    moved[axis] = moved_by_ulps(moved[axis], static_cast<int>(dice.below(7)) - 3);
  }
  return moved;
}

shared::QueryRay towards(const Wide& from, const Wide& to, Dice& dice) {
  const Vec3 origin(from), d = a_little_off(to, dice) - origin;
  return make_ray(origin, d == Vec3(0.0F) ? Vec3(0.0F, 0.0F, 1.0F) : d);
}

constexpr std::uint32_t kKinds = 8;

shared::QueryRay aim(const Target& target, std::uint32_t kind, Dice& dice) {
  const ShapeOracle& oracle = target.oracle;
  const long double reach = oracle.reach();
  const Wide far = oracle.place() + 3 * reach * direction(dice);
  switch (kind) {
    case 0:  // anywhere
      return towards(far, oracle.place() + reach * in_cube(dice, 0.8F), dice);
    case 1:
      return towards(far, rim_point(target, dice), dice);
    case 2: {  // along a tangent, on it or to either side
      const SurfacePoint at = any_point(target, dice);
      const Wide tangent = glm::normalize(glm::cross(at.normal, direction(dice)));
      const long double side = static_cast<long double>(dice.below(3)) - 1;
      const Wide p = at.p + at.normal * (side * reach * std::pow(10.0L, -2.0L - dice.below(6)));
      return towards(p - tangent * (2 * reach), p, dice);
    }
    case 3: {  // along a generator, or an axis of the frame
      const long double slope = target.shape.kind == HR_SHAPE_CONE ? static_cast<long double>(target.shape.form.y) : 0;
      const Wide along = glm::normalize(oracle.world_direction({slope, 0, 1}));
      const Wide p = dice.one_in(2) ? any_point(target, dice).p : rim_point(target, dice);
      return make_ray(Vec3(p - along * (2 * reach)), Vec3(along));
    }
    case 4:  // from near the middle
      return make_ray(Vec3(oracle.place() + 0.2L * reach * in_cube(dice, 1.0F)), any_direction(dice));
    case 5:  // from the surface
      return make_ray(Vec3(any_point(target, dice).p), any_direction(dice));
    case 6:  // from far away, closely past a rim
      return towards(oracle.place() + 1000 * reach * direction(dice),
                     rim_point(target, dice) + 3e-5L * reach * direction(dice), dice);
    default: {  // a direction with zeros
      Vec3 d(0.0F);
      d[static_cast<int>(dice.below(3))] = dice.one_in(2) ? 2.0F : -0.5F;
      return make_ray(Vec3(any_point(target, dice).p - Wide(d) * (2 * reach)), d);
    }
  }
}

}  // namespace

RayMaker at_shapes(const FlatScene& flat) {
  std::vector<Target> targets;
  for (const shared::Shape& shape : flat.shapes) targets.push_back({shape, ShapeOracle(shape)});
  if (targets.empty()) throw std::logic_error("nothing to aim at");
  return [targets = std::move(targets)](std::uint32_t count, std::uint32_t seed) {
    Dice dice(seed);
    Rays made;
    for (std::uint32_t i = 0; i < count; i++) {
      made.rays.push_back(aim(targets[i / kKinds % targets.size()], i % kKinds, dice));
      made.inside.push_back(0);
    }
    return made;
  };
}

}  // namespace hemiray::stability
