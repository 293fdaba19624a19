// Polygons into triangles.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "host/base/vec.hpp"

namespace hemiray {

/// Faces with more corners are refused by the readers: ear clipping takes time in the square of their number.
inline constexpr std::size_t kMaxFaceCorners = 4096;

/// True if the triangle has no area: its cross product, from differences in double, is exactly zero.
bool is_degenerate(const Vec3& a, const Vec3& b, const Vec3& c);

/// Triangulates a simple polygon, convex or not, by ear clipping in its own plane (Newell's normal), keeping its
/// orientation. `corners` holds 3 to kMaxFaceCorners finite positions in order. Appends triples of indices into
/// `corners`; a convex polygon without straight angles becomes a fan around corner 0. Self-intersecting polygons yield
/// some triangulation. Returns how many of the n - 2 triangles have no area and were left out.
std::size_t triangulate(std::span<const Vec3> corners, std::vector<std::array<std::uint32_t, 3>>& triangles);

}  // namespace hemiray
