#include "host/radiosity/hemicube_cells.hpp"

#include <cmath>
#include <numbers>

namespace hemiray {
namespace {

// To the rectangle [0, x] x [0, y] in the plane z = 1, from a surface element at the origin that faces it.
double top_corner(double x, double y) {
  const double rx = std::sqrt(1.0 + x * x), ry = std::sqrt(1.0 + y * y);
  return (x / rx * std::atan(y / rx) + y / ry * std::atan(x / ry)) / (2.0 * std::numbers::pi);
}

// To the rectangle y in [0, y], z in [0, z] in the plane x = 1, the element's normal being z.
double face_corner(double y, double z) {
  const double rz = std::sqrt(1.0 + z * z);
  return (std::atan(y) - std::atan(y / rz) / rz) / (2.0 * std::numbers::pi);
}

}  // namespace

std::vector<double> hemicube_cells(std::uint32_t resolution) {
  const double step = 2.0 / resolution;
  const auto across = [step](std::uint32_t i) { return i * step - 1.0; };
  std::vector<double> cells;
  cells.reserve(std::size_t{resolution} * resolution * 3 / 2);
  for (std::uint32_t y = 0; y < resolution; y++) {
    for (std::uint32_t x = 0; x < resolution; x++) {
      const double x0 = across(x), x1 = across(x + 1), y0 = across(y), y1 = across(y + 1);
      cells.push_back(top_corner(x1, y1) - top_corner(x0, y1) - top_corner(x1, y0) + top_corner(x0, y0));
    }
  }
  for (std::uint32_t z = 0; z < resolution / 2; z++) {
    for (std::uint32_t y = 0; y < resolution; y++) {
      const double y0 = across(y), y1 = across(y + 1), z0 = z * step, z1 = (z + 1) * step;
      cells.push_back(face_corner(y1, z1) - face_corner(y0, z1) - face_corner(y1, z0) + face_corner(y0, z0));
    }
  }
  return cells;
}

}  // namespace hemiray
