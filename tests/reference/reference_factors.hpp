// Form factors of triangles by an independent way: Lambert's closed form from a point to a polygon, integrated over the
// other triangle by adaptive cubature, in long double; and with obstacles, by brute force.
#pragma once

#include <array>
#include <cstdint>
#include <span>

namespace hemiray::reference {

using Real = long double;
struct Point {
  Real x, y, z;
};
using Corners = std::array<Point, 3>;  ///< counter-clockwise seen from the front [m]

/// The factor from a surface element at p with unit normal n to the front of triangle t: 0 from behind it.
Real point_factor(const Point& p, const Point& n, const Corners& t);

/// A_i F_ij [m^2] of the parts in front of each other, to about `tolerance` relative to it or 1e-4 of that times the
/// smaller area, whichever is larger.
Real exchange_area(const Corners& i, const Corners& j, Real tolerance);

/// A_i F_ij [m^2] with triangles in the way: a stratified grid of n x n parts of both, all pairs of their middles.
/// Obstacles block both ways. The visibility alone is sampled: the exchange with nothing in the way is exchange_area().
Real obstructed_area(const Corners& i, const Corners& j, std::span<const Corners> obstacles, std::uint32_t n);

}  // namespace hemiray::reference
