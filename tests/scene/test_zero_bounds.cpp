// How far surfaces reach: intervals hold what they should, boxes hold every point of a surface and are close to it.
#include <catch2/catch.hpp>

#include <cmath>
#include <glm/ext/matrix_transform.hpp>
#include <random>
#include <string>
#include <vector>

#include "host/scene/shape_geometry.hpp"
#include "host/scene/zero_bounds.hpp"

namespace hemiray {
namespace {

using Real = long double;

struct Item {
  const char* name;
  Shape shape;
  double slack;  // how much larger than the points found a box may be, as a share of the clip
};

Shape clipped(Shape shape, Clip clip, double size, const DVec3& center = DVec3(0.0)) {
  shape.clip = clip;
  shape.clip_half = DVec3(size);
  shape.clip_radius = size;
  shape.clip_center = center;
  return shape;
}

Shape implicit(const std::string& text, Clip clip, double size) {
  Shape shape;
  shape.kind = ShapeKind::implicit;
  shape.expression = parse_expression(text, {{"t", 0.5 * (1.0 + std::sqrt(5.0))}});
  return clipped(shape, clip, size);
}

Shape quadric(const std::array<double, 10>& coefficients, Clip clip, double size, const DVec3& center = DVec3(0.0)) {
  Shape shape;
  shape.kind = ShapeKind::quadric;
  shape.coefficients = coefficients;
  return clipped(shape, clip, size, center);
}

std::vector<Item> items() {
  return {
      {"sphere", implicit("x^2 + y^2 + z^2 - 1", Clip::box, 2.5), 0.01},
      {"torus", implicit("(x^2+y^2+z^2+0.72)^2 - 3.24*(x^2+y^2)", Clip::sphere, 2.0), 0.02},
      {"heart", implicit("(x^2 + 9/4*y^2 + z^2 - 1)^3 - x^2*z^3 - 9/80*y^2*z^3", Clip::box, 1.5), 0.03},
      {"Barth", implicit("4*(t^2*x^2-y^2)*(t^2*y^2-z^2)*(t^2*z^2-x^2) - (1+2*t)*(x^2+y^2+z^2-1)^2", Clip::sphere, 1.5),
       0.05},
      {"Chmutov", implicit("(2*(2*x^2-1)^2-1) + (2*(2*y^2-1)^2-1) + (2*(2*z^2-1)^2-1)", Clip::box, 1.2), 0.05},
      {"wavy sheet", implicit("z - x*y^3 + x^5/4", Clip::box, 1.0), 0.03},
      {"ellipsoid", quadric({2, 9, 1, 0.4, -0.3, 0.5, 0.2, 0.1, -0.3, -0.8}, Clip::none, 1.0), 0.05},
      {"clipped ellipsoid", quadric({2, 9, 1, 0.4, -0.3, 0.5, 0.2, 0.1, -0.3, -0.8}, Clip::box, 0.6, {0.3, 0, 0.2}),
       0.06},
      {"hyperboloid", quadric({1, 1, -1, 0, 0, 0, 0, 0, 0, -0.1}, Clip::box, 0.8), 0.02},
      {"paraboloid", quadric({1, 1, 0, 0, 0, 0, 0, 0, -0.7, 0}, Clip::sphere, 0.8, {0, 0, 0.4}), 0.02},
      {"saddle", quadric({1, -1, 0, 0.2, 0, 0, 0, 0, 0.8, 0}, Clip::sphere, 1.0), 0.04},
      {"double cone", quadric({1, 1, -0.5, 0, 0, 0, 0, 0, 0, 0}, Clip::box, 1.0), 0.02},
      {"half a cone from its apex", quadric({1, 1, -0.5, 0, 0, 0, 0, 0, 0, 0}, Clip::box, 1.0, {0, 0, 1}), 0.02},
      {"plane", quadric({0, 0, 0, 0, 0, 0, 0.3, 0.2, 1, 0.1}, Clip::sphere, 1.0), 0.04}};
}

double value(const Shape& s, const DVec3& p) {
  if (s.kind == ShapeKind::implicit) return evaluate(s.expression, p);
  const auto& k = s.coefficients;
  return k[0] * p.x * p.x + k[1] * p.y * p.y + k[2] * p.z * p.z + k[3] * p.x * p.y + k[4] * p.y * p.z +
         k[5] * p.z * p.x + k[6] * p.x + k[7] * p.y + k[8] * p.z + k[9];
}

bool in_clip(const Shape& s, const DVec3& p) {
  const DVec3 from = glm::abs(p - s.clip_center);
  if (s.clip == Clip::sphere) return glm::length(from) <= s.clip_radius;
  return s.clip == Clip::none || glm::all(glm::lessThanEqual(from, s.clip_half));
}

// Points of the surface on lines of a grid along each axis through the clip, where the function changes its sign.
std::vector<DVec3> points_of(const Shape& s, int lines) {
  std::vector<DVec3> points;
  const DVec3 middle = s.clip_center;
  const DVec3 half = s.clip == Clip::sphere ? DVec3(s.clip_radius) : s.clip_half;
  constexpr int kSteps = 60;
  for (int axis = 0; axis < 3; axis++) {
    for (int i = 0; i <= lines; i++) {
      for (int j = 0; j <= lines; j++) {
        DVec3 p, side(0.0);
        side[(axis + 1) % 3] = -1.0 + 2.0 * i / lines;
        side[(axis + 2) % 3] = -1.0 + 2.0 * j / lines;
        const auto at = [&](double w) {
          side[axis] = w;
          return middle + half * side;
        };
        for (int k = 0; k < kSteps; k++) {
          double lo = -1.0 + 2.0 * k / kSteps, hi = -1.0 + 2.0 * (k + 1) / kSteps;
          const double before = value(s, at(lo));
          if (before * value(s, at(hi)) > 0.0) continue;
          for (int step = 0; step < 60; step++) {
            const double mid = 0.5 * (lo + hi);
            (value(s, at(mid)) * before > 0.0 ? lo : hi) = mid;
          }
          p = at(lo);
          if (in_clip(s, p)) points.push_back(p);
        }
      }
    }
  }
  return points;
}

// From a point of the surface in small steps along it, farther and farther in a direction.
DVec3 climbed(const Shape& s, DVec3 p, const DVec3& toward) {
  double step = 0.02;
  // At a cusp Newton's method ends beside the surface.
  const auto on_surface = [&](const DVec3& q) {
    const DVec3 e = 1e-7 * glm::normalize(DVec3(0.3, -0.5, 0.8));
    return value(s, q - e) * value(s, q + e) <= 0.0;
  };
  const auto pulled = [&](DVec3 q) {  // onto the surface, by Newton's method
    for (int i = 0; i < 4; i++) {
      DVec3 g;
      for (int k = 0; k < 3; k++) {
        DVec3 e(0.0);
        e[k] = 1e-6;
        g[k] = (value(s, q + e) - value(s, q - e)) / 2e-6;
      }
      const double g2 = glm::dot(g, g);
      if (g2 == 0.0) return q;
      q -= g * (value(s, q) / g2);
    }
    return q;
  };
  for (int i = 0; i < 300 && step > 1e-9; i++) {
    const DVec3 next = pulled(p + step * glm::normalize(toward));
    if (in_clip(s, next) && on_surface(next) && glm::dot(toward, next) > glm::dot(toward, p)) {
      p = next;
    } else {
      step *= 0.6;
    }
  }
  return p;
}

}  // namespace

TEST_CASE("intervals hold sums, products and squares of what they hold") {
  std::mt19937 engine(3);
  std::uniform_real_distribution<double> uniform(-2.0, 2.0);
  const auto holds = [](const Interval& i, Real x) { return Real{i.lo} <= x && x <= Real{i.hi}; };
  const auto any = [&] {
    const double a = uniform(engine), b = uniform(engine);
    return Interval(std::min(a, b), std::max(a, b));
  };
  for (int i = 0; i < 20000; i++) {
    const Interval a = any(), b = any();
    for (const double x : {a.lo, a.hi, 0.5 * (a.lo + a.hi)}) {
      REQUIRE(holds(square(a), Real{x} * x));
      for (const double y : {b.lo, b.hi, 0.5 * (b.lo + b.hi)}) {
        REQUIRE(holds(a + b, Real{x} + y));
        REQUIRE(holds(a - b, Real{x} - y));
        REQUIRE(holds(a * b, Real{x} * y));
      }
    }
    REQUIRE(square(a).lo >= 0.0);
    REQUIRE((a * b).hi - (a * b).lo < 16.1);
  }
  const Interval huge(-1e300, 1e300);
  CHECK((huge * huge).hi == std::numeric_limits<double>::infinity());
  CHECK((huge * huge - huge * huge).may_be_zero());
  CHECK_FALSE(Interval(1e-300, 1.0).may_be_zero());
}

TEST_CASE("a shape's box holds every point of it and is hardly larger") {
  for (const Item& item : items()) {
    const std::vector<DVec3> points = points_of(item.shape, 40);
    REQUIRE(points.size() > 500);
    for (const double turn : {0.0, 0.7}) {
      Shape placed = item.shape;
      placed.to_world = glm::translate(DMat4(1.0), DVec3(3, -2, 1)) *
                        glm::rotate(DMat4(1.0), turn, glm::normalize(DVec3(1, 2, 3))) *
                        glm::scale(DMat4(1.0), DVec3(1.0, 0.7, 1.3));
      REQUIRE(shape_fault(placed).empty());
      const WorldBounds bounds = shape_bounds(placed);
      const glm::dmat3 linear(placed.to_world);
      WorldBounds found;
      for (const DVec3& p : points) found.add(DVec3(placed.to_world * glm::dvec4(p, 1.0)));
      for (int axis = 0; axis < 3; axis++) {
        for (const double sign : {1.0, -1.0}) {
          const DVec3 toward = sign * DVec3(linear[0][axis], linear[1][axis], linear[2][axis]);
          DVec3 best = points[0];
          for (const DVec3& p : points) {
            if (glm::dot(toward, p) > glm::dot(toward, best)) best = p;
          }
          found.add(DVec3(placed.to_world * glm::dvec4(climbed(item.shape, best, toward), 1.0)));
        }
      }
      const shared::Shape flat = flatten_shape(placed);
      const DVec3 flat_lo(flat.lo.x, flat.lo.y, flat.lo.z), flat_hi(flat.hi.x, flat.hi.y, flat.hi.z);
      const double slack = item.slack * 1.3 * (item.shape.clip == Clip::none ? 1.0 : item.shape.clip_radius);
      for (int axis = 0; axis < 3; axis++) {
        INFO(item.name << ", turned by " << turn << ", axis " << axis << ": box " << bounds.min[axis] << " to "
                       << bounds.max[axis] << ", points " << found.min[axis] << " to " << found.max[axis]);
        CHECK(bounds.max[axis] >= found.max[axis] - 1e-12);
        CHECK(bounds.min[axis] <= found.min[axis] + 1e-12);
        CHECK(bounds.max[axis] <= found.max[axis] + slack);
        CHECK(bounds.min[axis] >= found.min[axis] - slack);
        CHECK(flat_hi[axis] >= found.max[axis]);
        CHECK(flat_lo[axis] <= found.min[axis]);
      }
    }
  }
}

TEST_CASE("a surface without points in its clip is a fault, one that may have some is not") {
  CHECK(shape_fault(implicit("x^2 + y^2 + z^2 + 1", Clip::box, 2.0)).find("has no points there") != std::string::npos);
  CHECK(shape_fault(implicit("x^2 + y^2 + z^2 - 9", Clip::sphere, 2.0)).find("has no points there") !=
        std::string::npos);
  CHECK(shape_fault(implicit("x^2 + y^2 + z^2 - 9", Clip::sphere, 3.1)).empty());
  CHECK(shape_fault(quadric({1, 1, 1, 0, 0, 0, 0, 0, 0, -9}, Clip::box, 1.7)).find("has no points there") !=
        std::string::npos);
  CHECK(shape_fault(implicit("x^2 + y^2", Clip::box, 1.0)).empty());  // a line
  CHECK(shape_fault(implicit("x*y - y*x", Clip::box, 1.0)).find("0 everywhere") != std::string::npos);
}

}  // namespace hemiray
