// Disks, cylinders, cones and quadrics: rims, edges, tangents, at every size.
#include <array>
#include <glm/gtc/matrix_transform.hpp>
#include <utility>

#include "host/stability/aim_shapes.hpp"
#include "host/stability/rung.hpp"

namespace hemiray::stability {
namespace {

// About as large as 1 each.
Shape round_shape(ShapeKind kind, double radius, double upper_radius, double half_height, bool capped) {
  Shape s;
  s.kind = kind;
  s.radius = radius;
  s.upper_radius = upper_radius;
  s.half_height = half_height;
  s.capped = capped;
  return s;
}

Shape quadric(const std::array<double, 10>& coefficients, Clip clip = Clip::none) {
  Shape s;
  s.kind = ShapeKind::quadric;
  s.coefficients = coefficients;
  s.clip = clip;
  return s;
}

std::vector<Shape> disks() { return {round_shape(ShapeKind::disk, 0.9, 0.9, 0.5, true)}; }

std::vector<Shape> cylinders() {
  return {round_shape(ShapeKind::cylinder, 0.6, 0.6, 0.7, true), round_shape(ShapeKind::cylinder, 0.6, 0.6, 0.7, false),
          round_shape(ShapeKind::cylinder, 0.002, 0.002, 1.0, true)};
}

std::vector<Shape> cones() {
  return {round_shape(ShapeKind::cone, 0.7, 0.0, 0.6, true), round_shape(ShapeKind::cone, 0.3, 0.8, 0.5, true),
          round_shape(ShapeKind::cone, 0.0, 0.8, 0.5, false), round_shape(ShapeKind::cone, 0.9, 0.1, 0.05, true)};
}

// Sphere, ellipsoid, hyperboloid, paraboloid, saddle, double cone.
std::vector<Shape> quadrics() {
  return {quadric({1, 1, 1, 0, 0, 0, 0, 0, 0, -1}),
          quadric({2, 9, 1, 0.4, -0.3, 0.5, 0.2, 0.1, -0.3, -0.8}),
          quadric({1, 1, -1, 0, 0, 0, 0, 0, 0, -0.1}, Clip::box),
          quadric({1, 1, 0, 0, 0, 0, 0, 0, -0.7, 0}, Clip::sphere),
          quadric({1, -1, 0, 0.2, 0, 0, 0, 0, 0.8, 0}, Clip::sphere),
          quadric({1, 1, -0.5, 0, 0, 0, 0, 0, 0, 0}, Clip::box)};
}

// In a row, askew, none within another's reach.
Rung row_of(std::string name, std::vector<Shape> shapes, double scale) {
  Scene scene;
  scene.materials.emplace_back();
  const DMat4 turn = glm::rotate(DMat4(1.0), 0.83, glm::normalize(DVec3(1.0, 2.0, 0.7)));
  double place = 0.0;
  for (Shape& shape : shapes) {
    shape.to_world = glm::scale(DMat4(1.0), DVec3(scale)) * glm::translate(DMat4(1.0), DVec3(place, 0.3, -0.2)) * turn;
    place += 4.0;
    scene.shapes.push_back(shape);
  }
  Rung rung;
  rung.name = std::move(name);
  rung.flat = flatten_scene(scene);
  rung.rays = at_shapes(rung.flat);
  return rung;
}

Case sized(std::string name, std::string what, std::vector<Shape> (*shapes)()) {
  Case sizes{std::move(name), std::move(what), {}};
  constexpr std::pair<const char*, double> kScales[] = {{"1e-3", 1e-3}, {"1", 1.0}, {"1e3", 1e3}, {"1e6", 1e6}};
  for (const auto& [rung, scale] : kScales) {
    sizes.rungs.emplace_back([rung = rung, shapes, scale = scale] { return row_of(rung, shapes(), scale); });
  }
  return sizes;
}

}  // namespace

std::vector<Case> analytic_cases() {
  return {sized("disks",
                "A disk of that size, and rays anywhere, at its rim, in its plane, from it, and from a thousand times "
                "its size past its rim.",
                disks),
          sized("cylinders", "The same at a closed one, an open one and a wire: edges, tangents and generators, too.",
                cylinders),
          sized("cones", "The same at a pointed, a truncated, an open and a flat cone, and at the apexes.", cones),
          sized("quadrics",
                "The same at a sphere, an ellipsoid, a hyperboloid, a paraboloid, a saddle and a double cone, with "
                "tangents missed by 1e-2 to 1e-7 of the size.",
                quadrics)};
}

}  // namespace hemiray::stability
