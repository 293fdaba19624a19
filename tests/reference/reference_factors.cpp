#include "tests/reference/reference_factors.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace hemiray::reference {
namespace {

Point operator+(const Point& a, const Point& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
Point operator-(const Point& a, const Point& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
Point operator*(const Point& a, Real s) { return {a.x * s, a.y * s, a.z * s}; }
Real dot(const Point& a, const Point& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
Point cross(const Point& a, const Point& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
Real length(const Point& a) { return std::sqrt(dot(a, a)); }
Point normal_of(const Corners& t) {
  const Point n = cross(t[1] - t[0], t[2] - t[0]);
  return n * (1.0L / length(n));
}
Real area_of(const Corners& t) { return 0.5L * length(cross(t[1] - t[0], t[2] - t[0])); }

// Dunavant 1985, degree 8: 16 points.
struct Node {
  Real a, b, weight;  // barycentric of the first two corners
};
const std::vector<Node>& nodes() {
  static const std::vector<Node> all = [] {
    std::vector<Node> list = {{1.0L / 3, 1.0L / 3, 0.144315607677787L}};
    const auto three = [&list](Real a, Real w) {
      const Real b = (1 - a) / 2;
      list.insert(list.end(), {{a, b, w}, {b, a, w}, {b, b, w}});
    };
    three(0.081414823414554L, 0.095091634267285L);
    three(0.658861384496480L, 0.103217370534718L);
    three(0.898905543365938L, 0.032458497623198L);
    const Real a = 0.008394777409958L, b = 0.263112829634638L, c = 1 - a - b, w = 0.027230314174435L;
    list.insert(list.end(), {{a, b, w}, {b, a, w}, {a, c, w}, {c, a, w}, {b, c, w}, {c, b, w}});
    return list;
  }();
  return all;
}

Real once(const Corners& i, const Point& n, const Corners& j) {
  Real sum = 0;
  for (const Node& node : nodes()) {
    const Point p = i[0] * node.a + i[1] * node.b + i[2] * (1 - node.a - node.b);
    sum += node.weight * point_factor(p, n, j);
  }
  return sum * area_of(i);
}

Real adapt(const Corners& i, const Point& n, const Corners& j, Real coarse, Real tolerance, int depth) {
  const Point ab = (i[0] + i[1]) * 0.5L, bc = (i[1] + i[2]) * 0.5L, ca = (i[2] + i[0]) * 0.5L;
  const std::array<Corners, 4> parts = {{{i[0], ab, ca}, {ab, i[1], bc}, {ca, bc, i[2]}, {ab, bc, ca}}};
  std::array<Real, 4> values{};
  Real sum = 0;
  for (std::size_t k = 0; k < 4; k++) sum += values[k] = once(parts[k], n, j);
  if (std::abs(sum - coarse) <= tolerance || depth == 0) return sum;
  Real fine = 0;
  for (std::size_t k = 0; k < 4; k++) fine += adapt(parts[k], n, j, values[k], tolerance / 3, depth - 1);
  return fine;
}

bool meets(const Point& from, const Point& to, const Corners& t) {
  const Point d = to - from, e1 = t[1] - t[0], e2 = t[2] - t[0], h = cross(d, e2);
  const Real det = dot(e1, h);
  if (det == 0) return false;
  const Point s = from - t[0], q = cross(s, e1);
  const Real u = dot(s, h) / det, v = dot(d, q) / det, at = dot(e2, q) / det;
  return u >= 0 && v >= 0 && u + v <= 1 && at > 1e-9L && at < 1 - 1e-9L;
}

std::vector<Point> middles(const Corners& t, std::uint32_t n) {
  std::vector<Point> all;
  const Point u = (t[1] - t[0]) * (1.0L / n), v = (t[2] - t[0]) * (1.0L / n);
  for (std::uint32_t a = 0; a < n; a++) {
    for (std::uint32_t b = 0; a + b < n; b++) {
      all.push_back(t[0] + u * (a + 1.0L / 3) + v * (b + 1.0L / 3));
      if (a + b + 1 < n) all.push_back(t[0] + u * (a + 2.0L / 3) + v * (b + 2.0L / 3));
    }
  }
  return all;
}

}  // namespace

Real point_factor(const Point& p, const Point& n, const Corners& t) {
  if (dot(normal_of(t), p - t[0]) <= 0) return 0;
  std::vector<Point> front;
  for (std::size_t k = 0; k < 3; k++) {
    const Point a = t[k] - p, b = t[(k + 1) % 3] - p;
    const Real ha = dot(n, a), hb = dot(n, b);
    if (ha >= 0) front.push_back(a);
    if ((ha > 0 && hb < 0) || (ha < 0 && hb > 0)) front.push_back(a + (b - a) * (ha / (ha - hb)));
  }
  if (front.size() < 3) return 0;
  Real sum = 0;
  for (std::size_t k = 0; k < front.size(); k++) {
    const Point &a = front[k], &b = front[(k + 1) % front.size()];
    const Point c = cross(a, b);
    const Real s = length(c);
    if (s > 0) sum += std::atan2(s, dot(a, b)) * dot(n, c) / s;
  }
  return std::abs(sum) / (2 * std::numbers::pi_v<Real>);
}

Real exchange_area(const Corners& i, const Corners& j, Real tolerance) {
  const Point n = normal_of(i);
  const Real coarse = once(i, n, j);
  const Real smaller = std::min(area_of(i), area_of(j));
  return adapt(i, n, j, coarse, tolerance * std::max(coarse, 1e-4L * smaller), 14);
}

Real obstructed_area(const Corners& i, const Corners& j, std::span<const Corners> obstacles, std::uint32_t n) {
  const Point ni = normal_of(i), nj = normal_of(j);
  Real all = 0, through = 0;
  const std::vector<Point> from = middles(i, n), to = middles(j, n);
  for (const Point& p : from) {
    for (const Point& q : to) {
      const Point d = q - p;
      const Real h = dot(ni, d), g = -dot(nj, d), r2 = dot(d, d);
      if (h <= 0 || g <= 0) continue;
      const Real w = h * g / (r2 * r2);
      all += w;
      if (std::none_of(obstacles.begin(), obstacles.end(), [&](const Corners& o) { return meets(p, q, o); })) {
        through += w;
      }
    }
  }
  return all > 0 ? exchange_area(i, j, 1e-6L) * through / all : 0;
}

}  // namespace hemiray::reference
