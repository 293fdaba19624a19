#include "host/stability/passage.hpp"

#include <algorithm>
#include <cmath>

#include "host/stability/oracle.hpp"

namespace hemiray::stability {
namespace {

using Real = long double;

constexpr Real kUlp = 0x1p-23L;
constexpr Real kRelative = kBoundUlps * kUlp;
// Four roundings of the products in an edge function, and of their difference.
constexpr Real kProduct = 4.0L * 0x1p-24L;

std::size_t at(int i) { return static_cast<std::size_t>(i); }

// Distance of the origin from the segment.
Real distance_to_segment(Real px, Real py, Real qx, Real qy) {
  const Real ex = qx - px, ey = qy - py, length2 = ex * ex + ey * ey;
  const Real along = length2 > 0 ? std::clamp(-(px * ex + py * ey) / length2, 0.0L, 1.0L) : 0.0L;
  return std::hypot(px + along * ex, py + along * ey);
}

}  // namespace

Passage::Passage(const shared::QueryRay& ray, const std::array<Vec3, 3>& corner) {
  const Vec3 o(ray.origin.x, ray.origin.y, ray.origin.z), d(ray.direction.x, ray.direction.y, ray.direction.z);
  int kz = std::abs(d.x) > std::abs(d.y) ? 0 : 1;
  if (std::abs(d.z) > std::abs(d[kz])) kz = 2;
  const int kx = (kz + 1) % 3, ky = (kz + 2) % 3;
  for (int i = 0; i < 3; i++) {
    std::array<Real, 3> v{};
    for (int axis = 0; axis < 3; axis++) v[at(axis)] = static_cast<Real>(corner[at(i)][axis]) - o[axis];
    z_[at(i)] = v[at(kz)] / d[kz];
    x_[at(i)] = v[at(kx)] - z_[at(i)] * d[kx];
    y_[at(i)] = v[at(ky)] - z_[at(i)] * d[ky];
    off_[at(i)] = kRelative * std::max({std::abs(v[0]), std::abs(v[1]), std::abs(v[2])});
  }
  for (int i = 0; i < 3; i++) {
    const std::size_t p = at((i + 1) % 3), q = at((i + 2) % 3);
    area_[at(i)] = x_[p] * y_[q] - y_[p] * x_[q];
  }
}

bool Passage::is_near_side(int opposite) const {
  const std::size_t p = at((opposite + 1) % 3), q = at((opposite + 2) % 3);
  return distance_to_segment(x_[p], y_[p], x_[q], y_[q]) <= std::max(off_[p], off_[q]);
}

bool Passage::is_met_within_bound() const {
  const auto [least, most] = std::minmax({area_[0], area_[1], area_[2]});
  if (least >= 0 || most <= 0) return true;
  return is_near_side(0) || is_near_side(1) || is_near_side(2);
}

void Passage::interval(double* t, double* nearest, double* farthest) const {
  const auto [least, most] = std::minmax({z_[0], z_[1], z_[2]});
  const Real det = area();
  Real slope = 0, weights = 0, through = (least + most) / 2;
  if (det != 0) {
    const Real gx = ((z_[1] - z_[0]) * (y_[2] - y_[0]) - (z_[2] - z_[0]) * (y_[1] - y_[0])) / det;
    const Real gy = ((x_[1] - x_[0]) * (z_[2] - z_[0]) - (x_[2] - x_[0]) * (z_[1] - z_[0])) / det;
    slope = std::abs(gx) + std::abs(gy);
    through = std::clamp((area_[0] * z_[0] + area_[1] * z_[1] + area_[2] * z_[2]) / det, least, most);
  }
  const Real off = std::max({off_[0], off_[1], off_[2]});
  Real longest = 0, products = 0;
  for (int i = 0; i < 3; i++) {
    const std::size_t p = at((i + 1) % 3), q = at((i + 2) % 3);
    longest = std::max(longest, std::hypot(x_[p] - x_[q], y_[p] - y_[q]));
    const Real rounded = kProduct * (std::abs(x_[p] * y_[q]) + std::abs(y_[p] * x_[q]));
    weights += rounded * std::abs(z_[at(i)] - through);
    products += rounded;
  }
  // Too thin for the bound: the moved triangle may face anywhere, or the weights are anything.
  const bool anywhere = 4 * (off * longest + products) >= std::abs(det);
  const Real by = anywhere ? most - least : 2 * (slope * off + weights / std::abs(det));
  const Real far = std::max(std::abs(least), std::abs(most));
  *t = static_cast<double>(through);
  *nearest = static_cast<double>(std::max(through - by, least) - kRelative * far);
  *farthest = static_cast<double>(std::min(through + by, most) + kRelative * far);
}

}  // namespace hemiray::stability
