#include "host/scene/shape_geometry.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "host/scene/tape_value.hpp"
#include "host/scene/zero_bounds.hpp"

namespace hemiray {
namespace {

// Sizes whose squares, times those of directions, a float still holds [m].
constexpr double kLeastReach = 1e-15;
constexpr double kMostReach = 1e15;
// Largest |L| |L^-1| (norms of largest row sums) of a transform: rounding in the shape's frame grows by it.
constexpr double kMostGrowth = 1e3;
// A symmetric matrix whose smallest minor is below this share of what it could be is not called definite.
constexpr double kDefinite = 1e-12;
// A quadric's bounds hold for all whose coefficients differ by no more than this share: rounded to float, and with what
// the kernels' sums round.
constexpr double kCoefficientError = 1e-6;
// Boxes are larger by this share of the shape's reach: what kernels/lib/shape.h may take a ray for that passes by.
constexpr double kHitError = 4e-6;

double norm(const glm::dmat3& m) {
  double most = 0.0;
  for (int row = 0; row < 3; row++) {
    most = std::max(most, std::abs(m[0][row]) + std::abs(m[1][row]) + std::abs(m[2][row]));
  }
  return most;
}

// p^T A p + 2 b p + c.
struct Quadric {
  glm::dmat3 a{0.0};
  DVec3 b{0.0};
  double c = 0.0;

  [[nodiscard]] double value(const DVec3& p) const { return glm::dot(p, a * p + 2.0 * b) + c; }
  [[nodiscard]] Quadric from(const DVec3& origin) const { return {a, b + a * origin, value(origin)}; }
};

Quadric quadric_of(const Shape& s) {
  const auto& k = s.coefficients;
  Quadric q;
  q.a = glm::dmat3(k[0], k[3] / 2.0, k[5] / 2.0, k[3] / 2.0, k[1], k[4] / 2.0, k[5] / 2.0, k[4] / 2.0, k[2]);
  q.b = DVec3(k[6], k[7], k[8]) / 2.0;
  q.c = k[9];
  return q;
}

// (p - center)^T shape^-1 (p - center) = 1.
struct Ellipsoid {
  DVec3 center;
  glm::dmat3 shape;
};

// Sylvester's criterion on A or -A.
bool is_definite(const glm::dmat3& a) {
  const double first = a[0][0], second = a[0][0] * a[1][1] - a[1][0] * a[0][1], third = glm::determinant(a);
  const double size = norm(a);
  return std::abs(first) > kDefinite * size && second > kDefinite * size * size &&
         std::abs(third) > kDefinite * size * size * size && (first > 0.0) == (third > 0.0);
}

// Of a bounded quadric; `shape` is not positive where the quadric has no points.
std::optional<Ellipsoid> ellipsoid_of(const Quadric& q) {
  if (!is_definite(q.a)) return {};
  const glm::dmat3 inverse = glm::inverse(q.a);
  const DVec3 center = -(inverse * q.b);
  return Ellipsoid{center, inverse * -q.value(center)};
}

// The shape about its middle: what is stored on the device, before rounding.
struct Placed {
  glm::dmat3 to_world;  // own -> world, without `place`
  DVec3 place;
  Quadric quadric;
  std::optional<Ellipsoid> ellipsoid;  // of a quadric without clip
};

Placed place_shape(const Shape& s) {
  Placed placed{glm::dmat3(s.to_world), DVec3(s.to_world[3]), {}, {}};
  if (s.kind != ShapeKind::quadric) return placed;
  const Quadric given = quadric_of(s);
  DVec3 middle = s.clip_center;
  if (s.clip == Clip::none) {
    placed.ellipsoid = ellipsoid_of(given);
    middle = placed.ellipsoid ? placed.ellipsoid->center : DVec3(0.0);
  }
  placed.quadric = given.from(middle);
  placed.place = DVec3(s.to_world * glm::dvec4(middle, 1.0));
  return placed;
}

DVec3 clip_half(const Shape& s) { return s.clip == Clip::box ? s.clip_half : DVec3(s.clip_radius); }

ClipRegion clip_region(const Shape& s, const DVec3& center) { return {center, clip_half(s), s.clip == Clip::sphere}; }

template <typename Number>
Number quadric_value(const Quadric& q, const Number& x, const Number& y, const Number& z) {
  const auto about = [](double k) {
    return Number(Interval(k) * Interval(1.0 - kCoefficientError, 1.0 + kCoefficientError));
  };
  const auto &a = q.a, two = 2.0 * q.a;
  return about(a[0][0]) * square(x) + about(a[1][1]) * square(y) + about(a[2][2]) * square(z) +
         about(two[0][1]) * (x * y) + about(two[1][2]) * (y * z) + about(two[0][2]) * (z * x) + about(2.0 * q.b.x) * x +
         about(2.0 * q.b.y) * y + about(2.0 * q.b.z) * z + about(q.c);
}

// What is 0 on the shape's surface; of a quadric about the place.
BoxFunction surface_function(const Shape& s, const Placed& placed) {
  if (s.kind == ShapeKind::quadric) {
    return {[q = placed.quadric](const Jet& x, const Jet& y, const Jet& z) { return quadric_value(q, x, y, z); },
            [q = placed.quadric](const Interval& x, const Interval& y, const Interval& z) {
              return quadric_value(q, x, y, z);
            }};
  }
  const std::span<const shared::uint4> tape = s.expression.tape;
  return {[tape](const Jet& x, const Jet& y, const Jet& z) { return evaluate_tape(tape, x, y, z); },
          [tape](const Interval& x, const Interval& y, const Interval& z) { return evaluate_tape(tape, x, y, z); }};
}

WorldBounds clipped_bounds(const Shape& s, const Placed& placed) {
  const ClipRegion clip = clip_region(s, s.kind == ShapeKind::quadric ? DVec3(0.0) : s.clip_center);
  return zero_bounds(surface_function(s, placed), clip, placed.to_world, placed.place);
}

bool has_points(const Shape& s, const Placed& placed) {
  const ClipRegion clip = clip_region(s, s.kind == ShapeKind::quadric ? DVec3(0.0) : s.clip_center);
  return farthest_zero(surface_function(s, placed), clip, DVec3(1.0, 0.0, 0.0)) >
         -std::numeric_limits<double>::infinity();
}

// Half the extents along the world's axes of a circle of radius 1 in the frame's xy plane.
DVec3 circle_extent(const glm::dmat3& to_world) {
  return glm::sqrt(to_world[0] * to_world[0] + to_world[1] * to_world[1]);
}

WorldBounds bounds_of(const Shape& s, const Placed& placed) {
  WorldBounds bounds;
  const auto add_disk = [&](double z, double radius) {
    const DVec3 center = placed.place + placed.to_world[2] * z, half = circle_extent(placed.to_world) * radius;
    bounds.add(center - half);
    bounds.add(center + half);
  };
  if (s.kind == ShapeKind::disk) {
    add_disk(0.0, s.radius);
  } else if (s.kind == ShapeKind::implicit) {
    bounds = clipped_bounds(s, placed);
  } else if (s.kind != ShapeKind::quadric) {
    add_disk(-s.half_height, s.radius);
    add_disk(s.half_height, s.upper_radius);
  } else if (placed.ellipsoid) {
    const glm::dmat3 spread = placed.to_world * placed.ellipsoid->shape * glm::transpose(placed.to_world);
    const DVec3 half = glm::sqrt(glm::max(DVec3(spread[0][0], spread[1][1], spread[2][2]), 0.0));
    bounds.add(placed.place - half);
    bounds.add(placed.place + half);
  } else if (s.clip != Clip::none) {
    bounds = clipped_bounds(s, placed);
  }
  return bounds;
}

double reach_of(const WorldBounds& bounds, const DVec3& place) {
  return glm::length(glm::max(glm::abs(bounds.min - place), glm::abs(bounds.max - place)));
}

// Places in general position: a polynomial of degree 16 or less that is 0 on all of them is 0 everywhere.
bool is_zero_everywhere(const Shape& s) {
  constexpr int kPlaces = 64;
  if (s.kind != ShapeKind::implicit) return false;
  for (int i = 1; i <= kPlaces; i++) {
    const auto coordinate = [i](double rate) { return std::fmod(i * rate, 1.0) - 0.5; };
    if (evaluate(s.expression, DVec3(coordinate(0.8191725), coordinate(0.6710436), coordinate(0.5497005))) != 0.0)
      return false;
  }
  return true;
}

std::string clip_fault(const Shape& s, const Placed& placed) {
  const DVec3 half = clip_half(s);
  if (!(std::min({half.x, half.y, half.z}) > 0.0)) return "its clip must be larger than nothing";
  if (is_zero_everywhere(s)) return "its expression is 0 everywhere: it is no surface";
  if (!has_points(s, placed)) return "its clip must hold a part of the surface: it has no points there";
  return {};
}

std::string quadric_fault(const Shape& s, const Placed& placed) {
  for (const double k : s.coefficients) {
    if (!(std::abs(k) <= kMostReach)) return "its coefficients must be finite and at most 1e15";
  }
  if (std::all_of(s.coefficients.begin(), s.coefficients.end() - 1, [](double k) { return k == 0.0; })) {
    return "one of its coefficients other than that of 1 must not be zero: else it is no surface";
  }
  if (s.clip == Clip::none) {
    if (!placed.ellipsoid) return "must have a clip: the quadric is unbounded";
    if (!(placed.ellipsoid->shape[0][0] > 0.0)) return "its coefficients must have a real solution: it has no points";
    return {};
  }
  return clip_fault(s, placed);
}

shared::float4 row_of(const glm::dmat3& m, int row, double w) {
  return {static_cast<float>(m[0][row]), static_cast<float>(m[1][row]), static_cast<float>(m[2][row]),
          static_cast<float>(w)};
}

shared::float4 to_float4(const DVec3& v, double w) {
  return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z), static_cast<float>(w)};
}

DVec3 xyz(const shared::float4& v) { return {v.x, v.y, v.z}; }

float rounded_down(double x) {
  const auto nearest = static_cast<float>(x);
  return static_cast<double>(nearest) <= x ? nearest : std::nextafter(nearest, -std::numeric_limits<float>::infinity());
}

float rounded_up(double x) { return -rounded_down(-x); }

// The power of two that makes the quadric's values distances in order of magnitude, exactly: products of them with
// others stay in the range of a float.
double unit_scale(const Quadric& q, double size) {
  const double slope = std::max({norm(q.a) * size, norm(glm::dmat3(q.b, q.b, q.b)), std::abs(q.c) / size});
  return std::ldexp(1.0, -std::ilogb(slope));
}

void set_quadric(const Shape& s, const Placed& placed, shared::Shape& flat) {
  double size = 0.0;
  if (placed.ellipsoid) {
    const glm::dmat3& m = placed.ellipsoid->shape;
    size = std::sqrt(std::max({m[0][0], m[1][1], m[2][2]}));
  } else {
    const DVec3 half = clip_half(s);
    size = std::max({half.x, half.y, half.z});
  }
  const double scale = unit_scale(placed.quadric, size);
  const glm::dmat3 a = placed.quadric.a * scale;
  flat.form = to_float4({a[0][0], a[1][1], a[2][2]}, placed.quadric.c * scale);
  flat.mixed = to_float4({a[0][1], a[1][2], a[0][2]}, 0.0);
  flat.linear = to_float4(placed.quadric.b * scale, 0.0);
  if (s.clip == Clip::box) flat.flags = HR_SHAPE_CLIP_BOX;
  if (s.clip == Clip::sphere) flat.flags = HR_SHAPE_CLIP_SPHERE;
  if (s.clip != Clip::none) flat.clip = to_float4(clip_half(s), s.clip_radius);
}

}  // namespace

std::string shape_fault(const Shape& s) {
  for (int column = 0; column < 4; ++column) {
    for (int row = 0; row < 4; ++row) {
      if (!(std::abs(s.to_world[column][row]) <= kMostReach)) return "must be placed within 1e15 m";
    }
  }
  const glm::dmat3 linear(s.to_world);
  if (glm::determinant(linear) == 0.0 || !(norm(linear) * norm(glm::inverse(linear)) < kMostGrowth)) {
    return "must not be scaled along one axis more than about 300 times as much as along another";
  }
  const bool round = s.kind != ShapeKind::quadric && s.kind != ShapeKind::implicit;
  if (round && !(s.radius >= 0.0 && s.upper_radius >= 0.0)) return "its radii must not be negative";
  if (s.kind == ShapeKind::disk && !(s.radius > 0.0)) return "its radius must be greater than 0";
  if (round && s.kind != ShapeKind::disk) {
    if (!(s.radius + s.upper_radius > 0.0)) return "one of its radii must be greater than 0";
    if (!(s.half_height > 0.0)) return "its ends must not coincide";
  }
  const Placed placed = place_shape(s);
  if (s.kind == ShapeKind::implicit) {
    if (s.expression.tape.empty()) return "must have an expression";
    if (s.clip == Clip::none) return "must have a clip";
    const std::string fault = clip_fault(s, placed);
    if (!fault.empty()) return fault;
  } else if (!round) {
    const std::string fault = quadric_fault(s, placed);
    if (!fault.empty()) return fault;
  }
  // What is clipped may be smaller than its clip, but is sought in all of it.
  const bool clipped = s.clip != Clip::none && !round;
  const double reach =
      clipped ? glm::length(placed.to_world * clip_half(s)) : reach_of(bounds_of(s, placed), placed.place);
  if (!(reach >= kLeastReach && reach <= kMostReach))
    return fmt::format("its size must be from 1e-15 to 1e15 m, found {:.3g}", reach);
  return {};
}

WorldBounds shape_bounds(const Shape& shape) { return bounds_of(shape, place_shape(shape)); }

shared::Shape flatten_shape(const Shape& s) {
  Placed placed = place_shape(s);
  const glm::dmat3 to_own = glm::inverse(placed.to_world);
  shared::Shape flat{};
  flat.to_own_x = row_of(to_own, 0, placed.place.x);
  flat.to_own_y = row_of(to_own, 1, placed.place.y);
  flat.to_own_z = row_of(to_own, 2, placed.place.z);
  flat.material = s.material;
  if (s.kind == ShapeKind::disk) {
    flat.kind = HR_SHAPE_DISK;
    flat.form.x = static_cast<float>(s.radius);
  } else if (s.kind == ShapeKind::implicit) {
    flat.kind = HR_SHAPE_IMPLICIT;
    flat.flags = s.clip == Clip::box ? HR_SHAPE_CLIP_BOX : HR_SHAPE_CLIP_SPHERE;
    flat.clip = to_float4(clip_half(s), s.clip_radius);
    flat.linear = to_float4(s.clip_center, 0.0);
  } else if (s.kind == ShapeKind::quadric) {
    flat.kind = HR_SHAPE_QUADRIC;
    set_quadric(s, placed, flat);
  } else {
    flat.kind = HR_SHAPE_CONE;
    const double mean = (s.radius + s.upper_radius) / 2.0, slope = (s.upper_radius - s.radius) / (2.0 * s.half_height);
    flat.form = to_float4({mean, slope, s.half_height}, 0.0);
    flat.flags = s.capped ? HR_SHAPE_CAPPED : 0U;
  }
  // Bounds of what is stored: in the frame as rounded.
  placed.place = {flat.to_own_x.w, flat.to_own_y.w, flat.to_own_z.w};
  placed.to_world =
      glm::inverse(glm::transpose(glm::dmat3(xyz(flat.to_own_x), xyz(flat.to_own_y), xyz(flat.to_own_z))));
  const WorldBounds bounds = bounds_of(s, placed);
  const double reach = reach_of(bounds, placed.place), pad = kHitError * reach;
  flat.lo = {rounded_down(bounds.min.x - pad), rounded_down(bounds.min.y - pad), rounded_down(bounds.min.z - pad),
             rounded_up(reach)};
  flat.hi = {rounded_up(bounds.max.x + pad), rounded_up(bounds.max.y + pad), rounded_up(bounds.max.z + pad), 0.0F};
  return flat;
}

}  // namespace hemiray
