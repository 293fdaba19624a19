// Shapes of every kind about as large as 1, and rays aimed where shapes are hard: rims, tangents, generators, from
// inside, from the surface, from far away.
#pragma once

#include <catch2/catch.hpp>

#include <array>
#include <cmath>
#include <glm/ext/matrix_transform.hpp>
#include <numbers>
#include <string>
#include <vector>

#include "host/scene/shape_geometry.hpp"
#include "host/stability/shape_oracle.hpp"
#include "tests/bvh/query_bench.hpp"

namespace hemiray::test {

using stability::ShapeOracle;
using stability::SurfaceHit;
using stability::Wide;
using stability::wide;

struct NamedShape {
  std::string name;
  Shape shape;
  bool convex;  // what leaves it never meets it again
};

inline Shape round_shape(ShapeKind kind, double radius, double upper_radius, double half_height, bool capped) {
  Shape s;
  s.kind = kind;
  s.radius = radius;
  s.upper_radius = upper_radius;
  s.half_height = half_height;
  s.capped = capped;
  return s;
}

inline Shape quadric(const std::array<double, 10>& coefficients, Clip clip = Clip::none) {
  Shape s;
  s.kind = ShapeKind::quadric;
  s.coefficients = coefficients;
  s.clip = clip;
  return s;
}

// One of each, about as large as 1.
inline std::vector<NamedShape> shapes_of_size_one() {
  std::vector<NamedShape> all;
  all.push_back({"disk", round_shape(ShapeKind::disk, 0.9, 0.9, 0.5, true), true});
  all.push_back({"cylinder", round_shape(ShapeKind::cylinder, 0.6, 0.6, 0.7, true), true});
  all.push_back({"pipe", round_shape(ShapeKind::cylinder, 0.6, 0.6, 0.7, false), false});
  all.push_back({"wire", round_shape(ShapeKind::cylinder, 0.002, 0.002, 1.0, true), true});
  all.push_back({"cone", round_shape(ShapeKind::cone, 0.7, 0.0, 0.6, true), true});
  all.push_back({"frustum", round_shape(ShapeKind::cone, 0.3, 0.8, 0.5, true), true});
  all.push_back({"open cone", round_shape(ShapeKind::cone, 0.0, 0.8, 0.5, false), false});
  all.push_back({"flat cone", round_shape(ShapeKind::cone, 0.9, 0.1, 0.05, true), true});
  all.push_back({"sphere", quadric({1, 1, 1, 0, 0, 0, 0, 0, 0, -1}), true});
  all.push_back({"ellipsoid", quadric({2, 9, 1, 0.4, -0.3, 0.5, 0.2, 0.1, -0.3, -0.8}), true});
  Shape hyperboloid = quadric({1, 1, -1, 0, 0, 0, 0, 0, 0, -0.1}, Clip::box);
  hyperboloid.clip_half = {0.9, 0.8, 0.7};
  all.push_back({"hyperboloid", hyperboloid, false});
  Shape bowl = quadric({1, 1, 0, 0, 0, 0, 0, 0, -0.7, 0}, Clip::sphere);
  bowl.clip_center = {0, 0, 0.4};
  bowl.clip_radius = 0.8;
  all.push_back({"paraboloid", bowl, false});
  Shape saddle = quadric({1, -1, 0, 0.2, 0, 0, 0, 0, 0.8, 0}, Clip::sphere);
  all.push_back({"saddle", saddle, false});
  Shape double_cone = quadric({1, 1, -0.5, 0, 0, 0, 0, 0, 0, 0}, Clip::box);
  all.push_back({"double cone", double_cone, false});
  Shape plane = quadric({0, 0, 0, 0, 0, 0, 0.3, 0.2, 1, 0.1}, Clip::box);
  all.push_back({"flat quadric", plane, true});
  return all;
}

inline DMat4 turned(Places& places) {
  return glm::rotate(DMat4(1.0), static_cast<double>(places.in(0.0F, 6.0F)), glm::normalize(DVec3(places.direction())));
}

inline Vec3 narrow(const Wide& v) {
  return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}

inline FlatScene scene_of(const shared::Shape& shape) {
  FlatScene flat = empty_flat_scene();
  flat.shapes.push_back(shape);
  return flat;
}

inline Wide random_direction(Places& places) { return glm::normalize(Wide(places.direction())); }

struct SurfacePoint {
  Wide p, normal;
  int part;
};

inline SurfacePoint random_point(const ShapeOracle& oracle, Places& places) {
  for (int attempt = 0; attempt < 10000; attempt++) {
    const Wide from = oracle.place() + oracle.reach() * Wide(places.in_cube(0.7F));
    const Wide d = attempt % 2 == 0 ? random_direction(places) : glm::normalize(oracle.place() - from);
    const auto hits = oracle.hits(from, d, 0);
    if (hits.empty()) continue;
    const SurfaceHit hit = hits[places.below(static_cast<std::uint32_t>(hits.size()))];
    const Wide p = from + d * hit.t;
    return {p, oracle.normal(hit.part, p), hit.part};
  }
  FAIL("no point of the shape found");
  return {};
}

// A point of the rim between side and caps, or the apex; of any other shape, of the surface.
inline Wide rim_point(const shared::Shape& shape, const ShapeOracle& oracle, Places& places) {
  if (shape.kind == HR_SHAPE_QUADRIC) return random_point(oracle, places).p;
  const long double turn = 2.0L * std::numbers::pi_v<long double> * static_cast<long double>(places.in(0.0F, 1.0F));
  long double z = 0, radius = shape.form.x;
  if (shape.kind == HR_SHAPE_CONE) {
    z = (places.below(2) == 0 ? -1 : 1) * static_cast<long double>(shape.form.z);
    radius = shape.form.x + shape.form.y * z;
  }
  return oracle.world({radius * std::cos(turn), radius * std::sin(turn), z});
}

inline shared::QueryRay aimed_ray(const shared::Shape& shape, const ShapeOracle& oracle, Places& places,
                                  std::uint32_t kind) {
  const long double reach = oracle.reach();
  const Wide far = oracle.place() + 3.0L * reach * random_direction(places);
  const auto towards = [&](const Wide& from, const Wide& to) {
    const Vec3 origin = narrow(from);
    Vec3 d = moved_by_ulps(narrow(to), places) - origin;
    if (d == Vec3(0.0F)) d = Vec3(0.0F, 0.0F, 1.0F);
    return make_ray(origin, d);
  };
  switch (kind) {
    case 0:  // anywhere
      return towards(far, oracle.place() + reach * Wide(places.in_cube(0.8F)));
    case 1:  // at a rim or the apex
      return towards(far, rim_point(shape, oracle, places));
    case 2: {  // along a tangent, on it or to either side
      const SurfacePoint at = random_point(oracle, places);
      const Wide tangent = glm::normalize(glm::cross(at.normal, random_direction(places)));
      const long double off = (places.below(3) - 1.0L) * reach * std::pow(10.0L, -2.0L - places.below(6));
      const Wide p = at.p + at.normal * off;
      return towards(p - tangent * (2 * reach), p);
    }
    case 3: {  // along a generator, or an axis of the frame
      const long double slope = shape.kind == HR_SHAPE_CONE ? static_cast<long double>(shape.form.y) : 0;
      const Wide along = glm::normalize(oracle.world_direction({slope, 0, 1}));
      const Wide p = places.below(2) == 0 ? random_point(oracle, places).p : rim_point(shape, oracle, places);
      return make_ray(narrow(p - along * (2 * reach)), narrow(along));
    }
    case 4:  // from inside
      return make_ray(narrow(oracle.place() + 0.2L * reach * Wide(places.in_cube(1.0F))), places.direction());
    case 5:  // from the surface
      return make_ray(narrow(random_point(oracle, places).p), places.direction());
    case 6: {  // from far away, closely past a rim
      const Wide target = rim_point(shape, oracle, places) + 3e-5L * reach * random_direction(places);
      return towards(oracle.place() + 1000.0L * reach * random_direction(places), target);
    }
    default: {  // a direction with zeros
      Vec3 d(0.0F);
      d[static_cast<int>(places.below(3))] = places.below(2) == 0 ? 2.0F : -0.5F;
      const Vec3 target = narrow(random_point(oracle, places).p);
      return make_ray(target - d * static_cast<float>(2 * reach), d);
    }
  }
}

inline constexpr std::uint32_t kRayKinds = 8;

inline Rays rays_at_shape(const shared::Shape& shape, std::size_t count, std::uint32_t seed) {
  const ShapeOracle oracle(shape);
  Places places(seed);
  Rays rays;
  while (rays.size() < count) {
    rays.push_back(aimed_ray(shape, oracle, places, static_cast<std::uint32_t>(rays.size()) % kRayKinds));
  }
  return rays;
}

}  // namespace hemiray::test
