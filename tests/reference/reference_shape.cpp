// Every surface but implicit ones is a polynomial of degree 1 or 2 along the ray, and a region that bounds it.
#include "tests/reference/reference_shape.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "tests/reference/reference_implicit.hpp"

namespace hemiray::reference {

namespace {

enum class Part { side, lower, upper };

constexpr double kOnSurface =
    0x1p-24;  // share of the shape's size within which a ray starts on it: its next hit is farther

DVec3 to_own(const DMat4& to_world, const DVec3& point) {
  return DVec3(glm::inverse(to_world) * glm::dvec4(point, 1.0));
}

double radius_at(const Shape& s, double z) {
  return 0.5 * (s.radius + s.upper_radius) + z * (s.upper_radius - s.radius) / (2.0 * s.half_height);
}

double value_at(const Shape& s, Part part, const DVec3& p) {
  if (part == Part::lower) return -p.z - s.half_height;
  if (part == Part::upper) return p.z - s.half_height;
  if (s.kind == ShapeKind::disk) return p.z;
  if (s.kind != ShapeKind::quadric) {
    const double r = radius_at(s, p.z);
    return p.x * p.x + p.y * p.y - r * r;
  }
  const auto& k = s.coefficients;
  return k[0] * p.x * p.x + k[1] * p.y * p.y + k[2] * p.z * p.z + k[3] * p.x * p.y + k[4] * p.y * p.z +
         k[5] * p.z * p.x + k[6] * p.x + k[7] * p.y + k[8] * p.z + k[9];
}

// By central differences, which are exact for polynomials of degree 2 but for rounding.
DVec3 gradient_at(const Shape& s, Part part, const DVec3& p, double step) {
  DVec3 gradient;
  for (int axis = 0; axis < 3; ++axis) {
    DVec3 offset(0.0);
    offset[axis] = step;
    gradient[axis] = (value_at(s, part, p + offset) - value_at(s, part, p - offset)) / (2.0 * step);
  }
  return gradient;
}

bool is_within(const Shape& s, Part part, const DVec3& p) {
  if (s.kind == ShapeKind::disk) return std::hypot(p.x, p.y) <= s.radius;
  if (s.kind != ShapeKind::quadric) {
    if (part == Part::side) return std::abs(p.z) <= s.half_height;
    return std::hypot(p.x, p.y) <= (part == Part::lower ? s.radius : s.upper_radius);
  }
  const DVec3 from = p - s.clip_center;
  if (s.clip == Clip::sphere) return glm::length(from) <= s.clip_radius;
  return s.clip == Clip::none || glm::all(glm::lessThanEqual(glm::abs(from), s.clip_half));
}

double size_of(const Shape& s) {
  if (s.kind == ShapeKind::disk) return s.radius;
  if (s.kind != ShapeKind::quadric) return std::max({s.radius, s.upper_radius, s.half_height});
  if (s.clip == Clip::sphere) return s.clip_radius;
  if (s.clip == Clip::box) return std::max({s.clip_half.x, s.clip_half.y, s.clip_half.z});
  // An ellipsoid about the origin of its frame, as the comparison scenes have them.
  return std::sqrt(std::abs(s.coefficients[9] / s.coefficients[0]));
}

std::array<Part, 3> parts_of(const Shape& s, std::size_t& count) {
  const bool capped = (s.kind == ShapeKind::cylinder || s.kind == ShapeKind::cone) && s.capped;
  count = capped ? 3 : 1;
  return {Part::side, Part::lower, Part::upper};
}

// The roots of the part's polynomial along o + t d, from its values at three points half a size apart.
std::array<double, 2> roots(const Shape& s, Part part, const DVec3& o, const DVec3& d) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  const double start = -glm::dot(o, d) / glm::dot(d, d);  // nearest to the frame's origin
  const double step = size_of(s) / glm::length(d);
  const auto at = [&](double t) { return value_at(s, part, o + d * (start + t)); };
  const double before = at(-step), c = at(0.0), after = at(step);
  const double b = (after - before) / (4.0 * step);  // half the linear coefficient
  const double a = (after + before - 2.0 * c) / (2.0 * step * step);
  if (std::abs(a) * step * step <= 1e-15 * (std::abs(b) * step + std::abs(c))) return {start - c / (2.0 * b), kNone};
  const double disc = b * b - a * c;
  if (disc < 0.0) return {kNone, kNone};
  const double q = -(b + std::copysign(std::sqrt(disc), b));
  return {start + q / a, start + c / q};
}

}  // namespace

std::optional<Hit> intersect_shape(const Shape& shape, const Ray& ray) {
  if (shape.kind == ShapeKind::implicit) return intersect_implicit(shape, ray);
  const DVec3 o = to_own(shape.to_world, ray.origin);
  const DVec3 d(glm::inverse(shape.to_world) * glm::dvec4(ray.direction, 0.0));
  const double size = size_of(shape);
  // A ray that leaves a part's surface: the root nearest to the origin is where it starts.
  std::optional<Hit> best;
  std::size_t count = 0;
  const auto parts = parts_of(shape, count);
  for (std::size_t i = 0; i < count; ++i) {
    const Part part = parts[i];
    auto found = roots(shape, part, o, d);
    if (ray.origin_error_m > 0.0) {
      const DVec3 gradient = gradient_at(shape, part, o, size);
      const double steepness = glm::length(gradient);
      if (steepness > 0.0 && std::abs(value_at(shape, part, o)) <= kOnSurface * size * steepness) {
        const bool first = !(std::abs(found[1]) < std::abs(found[0]));
        found[first ? 0 : 1] = -1.0;
      }
    }
    for (const double t : found) {
      if (!(t > 0.0) || (best && best->t_m <= t) || !is_within(shape, part, o + d * t)) continue;
      best = Hit{t, {}, DVec3(0.0)};
    }
  }
  return best;
}

DVec3 shape_normal(const Shape& shape, const DVec3& point) {
  if (shape.kind == ShapeKind::implicit) return implicit_normal(shape, point);
  const DVec3 p = to_own(shape.to_world, point);
  const double size = size_of(shape);
  std::size_t count = 0;
  const auto parts = parts_of(shape, count);
  // The part whose surface the point is nearest to.
  DVec3 normal(0.0);
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < count; ++i) {
    const DVec3 gradient = gradient_at(shape, parts[i], p, size);
    const double distance = std::abs(value_at(shape, parts[i], p)) / glm::length(gradient);
    if (!(distance < least)) continue;
    least = distance;
    normal = gradient;
  }
  return glm::normalize(glm::transpose(glm::dmat3(glm::inverse(shape.to_world))) * normal);
}

}  // namespace hemiray::reference
