// How a ray passes a triangle: in the plane across the ray, where it is the origin, with the bound of the answers.
#pragma once

#include <array>

#include "host/base/vec.hpp"
#include "shared/bvh_types.h"

namespace hemiray::stability {

/// The plane is the one that the kernels shear into: across the direction's longest axis.
class Passage {
 public:
  Passage(const shared::QueryRay& ray, const std::array<Vec3, 3>& corner);

  /// Distance of the ray from the side opposite to a corner, and what the bound makes of it.
  [[nodiscard]] bool is_near_side(int opposite) const;
  /// Whether the ray meets a triangle whose corners may be off by the bound.
  [[nodiscard]] bool is_met_within_bound() const;
  /// Twice the signed area of (ray, end, end) of the side opposite to a corner.
  [[nodiscard]] long double area(int opposite) const { return area_[static_cast<std::size_t>(opposite)]; }
  [[nodiscard]] long double area() const { return area_[0] + area_[1] + area_[2]; }
  /// Where the ray meets the plane of the triangle, within it, and the range that an answer may name [in lengths of the
  /// direction]. `t` if the caller knows it better.
  void interval(double* t, double* nearest, double* farthest) const;

 private:
  std::array<long double, 3> x_{}, y_{}, z_{};  // of the corners; z in lengths of the direction
  std::array<long double, 3> off_{};            // the bound of a corner's x and y
  std::array<long double, 3> area_{};
};

}  // namespace hemiray::stability
