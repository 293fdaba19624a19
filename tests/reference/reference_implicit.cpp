// No polynomial in t is ever made, unlike in the renderer: the tape is evaluated over intervals of t, with its
// derivative by the chain rule, and intervals are halved until they hold no zero, or one and a derivative without zero.
#include "tests/reference/reference_implicit.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <vector>

namespace hemiray::reference {

namespace {

using Real = long double;
using RealVec = std::array<Real, 3>;

constexpr Real kUlp = std::numeric_limits<Real>::epsilon();
constexpr Real kFinest = 1e-13L;        // of the clip's part of the ray: a narrower interval is one where it touches
constexpr double kOnSurface = 0x1p-24;  // as for the other shapes: share of the size within which a ray starts on it

struct Range {
  Real lo = 0, hi = 0;
  [[nodiscard]] bool holds_zero() const { return lo <= 0 && hi >= 0; }
};

Range widened(Real lo, Real hi) { return {lo - 2 * kUlp * std::abs(lo), hi + 2 * kUlp * std::abs(hi)}; }
Range sum(const Range& a, const Range& b) { return widened(a.lo + b.lo, a.hi + b.hi); }
Range negative(const Range& a) { return {-a.hi, -a.lo}; }
Range product(const Range& a, const Range& b) {
  const auto [least, most] = std::minmax({a.lo * b.lo, a.lo * b.hi, a.hi * b.lo, a.hi * b.hi});
  return widened(least, most);
}
Range squared(const Range& a) {
  const Range both = product(a, a);
  return a.holds_zero() ? Range{0, both.hi} : both;
}

// Value and derivative over an interval of t.
struct Course {
  Range value, rate;
};

Course product(const Course& a, const Course& b) {
  return {product(a.value, b.value), sum(product(a.value, b.rate), product(a.rate, b.value))};
}

Course course_of(const std::vector<shared::uint4>& tape, const std::array<Course, 3>& axis) {
  std::vector<Course> stack;
  for (const shared::uint4& op : tape) {
    const Real constant = Real{std::bit_cast<float>(op.z)} + Real{std::bit_cast<float>(op.w)};
    const Course fixed = {{constant, constant}, {0, 0}};
    if (op.x <= HR_TAPE_Z) {
      stack.push_back(axis[op.x]);
      continue;
    }
    if (op.x == HR_TAPE_PUSH) {
      stack.push_back(fixed);
      continue;
    }
    Course& top = stack.back();
    if (op.x == HR_TAPE_NEG) {
      top = {negative(top.value), negative(top.rate)};
    } else if (op.x == HR_TAPE_SQR) {
      top = {squared(top.value), product({2, 2}, product(top.value, top.rate))};
    } else if (op.x == HR_TAPE_ADD_CONST) {
      top.value = sum(top.value, fixed.value);
    } else if (op.x == HR_TAPE_MUL_CONST) {
      top = product(top, fixed);
    } else if (op.x == HR_TAPE_DUP) {
      stack.push_back(Course(top));
    } else if (op.x == HR_TAPE_MUL_UNDER) {
      top = product(top, stack[stack.size() - 2]);
    } else if (op.x == HR_TAPE_NIP) {
      stack.erase(stack.end() - 2);
    } else {
      Course right = top;
      stack.pop_back();
      Course left = stack.back();
      if (op.x == HR_TAPE_MUL) {
        stack.back() = product(left, right);
        continue;
      }
      if (op.x == HR_TAPE_SUB) right = {negative(right.value), negative(right.rate)};
      if (op.x == HR_TAPE_RSUB) left = {negative(left.value), negative(left.rate)};
      stack.back() = {sum(left.value, right.value), sum(left.rate, right.rate)};
    }
  }
  return stack.back();
}

RealVec to_own(const DMat4& to_world, const DVec3& v, Real w) {
  const glm::mat<4, 4, Real> inverse = glm::inverse(glm::mat<4, 4, Real>(to_world));
  const glm::vec<4, Real> own = inverse * glm::vec<4, Real>(v.x, v.y, v.z, w);
  return {own.x, own.y, own.z};
}

// The expression along o + t d, less its value at t = 0 where that is 0 but for rounding.
struct Line {
  const std::vector<shared::uint4>& tape;
  RealVec o, d;
  Real start = 0;
  bool starts_on_surface = false;

  [[nodiscard]] Course over(Real a, Real b) const {
    std::array<Course, 3> axis;
    for (std::size_t k = 0; k < 3; k++) {
      const Range way = {d[k], d[k]};
      axis[k] = {sum({o[k], o[k]}, product({a, b}, way)), way};
    }
    Course course = course_of(tape, axis);
    course.value = sum(course.value, {-start, -start});
    return course;
  }

  [[nodiscard]] Real at(Real t) const {
    const Range value = over(t, t).value;
    return (value.lo + value.hi) / 2;
  }
};

Real bisected(const Line& line, Real a, Real b) {
  const bool rises = line.at(b) > 0;
  for (int i = 0; i < 70; i++) {
    const Real middle = (a + b) / 2;
    ((line.at(middle) > 0) == rises ? b : a) = middle;
  }
  return (a + b) / 2;
}

std::optional<Real> first_change(const Line& line, Real a, Real b, Real finest) {
  const Course course = line.over(a, b);
  const bool at_start = a == 0 && line.starts_on_surface;
  if (!at_start) {
    const Real middle = (a + b) / 2, half = (b - a) / 2 * (1 + 4 * kUlp);
    const Range value = sum(line.over(middle, middle).value, product(course.rate, {-half, half}));
    if (!course.value.holds_zero() || !value.holds_zero()) return std::nullopt;
  }
  if (!course.rate.holds_zero()) {
    if (at_start || (line.at(a) > 0) == (line.at(b) > 0)) return std::nullopt;
    return bisected(line, a, b);
  }
  if (b - a < finest) return std::nullopt;
  const Real middle = (a + b) / 2;
  const auto first = first_change(line, a, middle, finest);
  return first ? first : first_change(line, middle, b, finest);
}

// The part of the line in the clip and beyond t = 0.
std::optional<Range> in_clip(const Shape& s, const Line& line) {
  Real near = 0, far = std::numeric_limits<Real>::infinity();
  if (s.clip == Clip::sphere) {
    Real a = 0, b = 0, c = -Real{s.clip_radius} * s.clip_radius;
    for (int k = 0; k < 3; k++) {
      const auto i = static_cast<std::size_t>(k);
      const Real from = line.o[i] - s.clip_center[k];
      a += line.d[i] * line.d[i];
      b += from * line.d[i];
      c += from * from;
    }
    const Real disc = b * b - a * c;
    if (disc < 0) return std::nullopt;
    near = std::max(near, (-b - std::sqrt(disc)) / a);
    far = (-b + std::sqrt(disc)) / a;
  } else {
    for (int k = 0; k < 3; k++) {
      const auto i = static_cast<std::size_t>(k);
      const Real from = line.o[i] - s.clip_center[k], half = s.clip_half[k];
      if (line.d[i] == 0) {
        if (std::abs(from) > half) return std::nullopt;
        continue;
      }
      const Real t0 = (-half - from) / line.d[i], t1 = (half - from) / line.d[i];
      near = std::max(near, std::min(t0, t1));
      far = std::min(far, std::max(t0, t1));
    }
  }
  if (!(near < far)) return std::nullopt;
  return Range{near, far};
}

std::array<Real, 3> gradient_at(const Shape& s, const RealVec& p) {
  std::array<Real, 3> gradient{};
  for (std::size_t k = 0; k < 3; k++) {
    Line line{s.expression.tape, p, {0, 0, 0}};
    line.d[k] = 1;
    const Range rate = line.over(0, 0).rate;
    gradient[k] = (rate.lo + rate.hi) / 2;
  }
  return gradient;
}

}  // namespace

std::optional<Hit> intersect_implicit(const Shape& shape, const Ray& ray) {
  Line line{shape.expression.tape, to_own(shape.to_world, ray.origin, 1), to_own(shape.to_world, ray.direction, 0)};
  const auto range = in_clip(shape, line);
  if (!range) return std::nullopt;
  if (ray.origin_error_m > 0.0) {
    const auto g = gradient_at(shape, line.o);
    const Real steepness = std::hypot(g[0], g[1], g[2]), value = line.at(0);
    const Real size = shape.clip == Clip::sphere ? shape.clip_radius
                                                 : std::max({shape.clip_half.x, shape.clip_half.y, shape.clip_half.z});
    line.starts_on_surface = std::abs(value) <= kOnSurface * size * steepness;
    if (line.starts_on_surface) line.start = value;
  }
  const auto t = first_change(line, range->lo, range->hi, kFinest * (range->hi - range->lo));
  if (!t) return std::nullopt;
  return Hit{static_cast<double>(*t), {}, DVec3(0.0)};
}

DVec3 implicit_normal(const Shape& shape, const DVec3& point) {
  const auto g = gradient_at(shape, to_own(shape.to_world, point, 1));
  const DVec3 own(static_cast<double>(g[0]), static_cast<double>(g[1]), static_cast<double>(g[2]));
  return glm::normalize(glm::transpose(glm::dmat3(glm::inverse(shape.to_world))) * own);
}

}  // namespace hemiray::reference
