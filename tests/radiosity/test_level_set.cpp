// Quadrics and implicit surfaces as patches: areas, topology, rims and the stated distance.
#include <catch2/catch.hpp>

#include <cmath>
#include <numbers>
#include <set>

#include "tests/radiosity/mesh_checks.hpp"
#include "tests/radiosity/radiosity_bench.hpp"

namespace hemiray {
namespace {

using test::area_of;
using test::edges_of;
using test::lonely_edges;

constexpr double kPi = std::numbers::pi;

PatchMesh cut(const std::string& object, double chord) {
  return make_patch_mesh(test::flat_from_json(object), {100.0, 0, chord});
}

// Vertices - edges + faces: 2 for what is like a ball, 0 for a ring.
int euler_characteristic(const PatchMesh& mesh) {
  std::set<test::Place> places;
  const auto edges = edges_of(mesh);
  for (const auto& [edge, count] : edges) places.insert({edge.first, edge.second});
  return static_cast<int>(places.size()) - static_cast<int>(edges.size()) + static_cast<int>(mesh.patch_count());
}

// Six times the volume within, if fronts are outside.
double signed_volume(const PatchMesh& mesh) {
  double sum = 0.0;
  for (const shared::uint4& t : mesh.flat.triangles) {
    const DVec3 a(test::vertex(mesh.flat, t.x)), b(test::vertex(mesh.flat, t.y)), c(test::vertex(mesh.flat, t.z));
    sum += glm::dot(a, glm::cross(b, c));
  }
  return sum / 6.0;
}

}  // namespace

TEST_CASE("an ellipsoid and a torus are cut closed, as what they are, to the stated distance") {
  struct Expected {
    std::string json;
    int euler;
    double area, volume;
  };
  const Expected all[] = {
      {R"json({ "type": "quadric", "material": "m", "coefficients": { "x2": 1, "y2": 1, "z2": 1, "1": -0.25 },
            "center": [1, 2, 3], "transform": { "scale": -1 } })json",
       2, kPi, kPi / 6.0},
      {R"json({ "type": "implicit", "material": "m", "expression": "(x^2+y^2+z^2+R^2-r^2)^2 - 4*R^2*(x^2+y^2)",
            "constants": { "R": 1, "r": 0.4 }, "clip": { "box": { "min": [-2, -2, -1], "max": [2, 2, 1] } } })json",
       0, 4.0 * kPi * kPi * 0.4, 2.0 * kPi * kPi * 0.16},
  };
  for (const Expected& e : all) {
    for (const double chord : {0.02, 0.002}) {
      const PatchMesh mesh = cut(e.json, chord);
      CAPTURE(e.json, mesh.patch_count(), mesh.chord_m);
      CHECK(mesh.chord_m <= chord);
      CHECK(lonely_edges(mesh) == 0);
      CHECK(euler_characteristic(mesh) == e.euler);
      // A chord moves a surface of radius r inwards by up to 1 / r of it: r is 0.4 at least.
      CHECK(std::abs(area_of(mesh) / e.area - 1.0) < chord / 0.4);
      CHECK(std::abs(signed_volume(mesh) / e.volume - 1.0) < 2.0 * chord / 0.4);
    }
  }
}

TEST_CASE("what a clip cuts off ends on it: a pipe in a box, a plane in a ball, a cone with its apex") {
  const double chord = 0.005;
  const PatchMesh pipe =
      cut(R"json({ "type": "quadric", "material": "m", "coefficients": { "x2": 1, "y2": 1, "1": -0.25 },
      "clip": { "box": { "min": [-1, -1, -1], "max": [1, 1, 1] } } })json",
          chord);
  CHECK(std::abs(area_of(pipe) / (2.0 * kPi) - 1.0) < 2.0 * chord);
  std::size_t rim = 0;
  for (const auto& [edge, count] : edges_of(pipe)) {
    if (count == 2) continue;
    CHECK(std::abs(edge.first[2]) == 1.0F);
    CHECK(edge.first[2] == edge.second[2]);
    rim++;
  }
  CHECK(rim > 30);

  const PatchMesh plane = cut(R"json({ "type": "quadric", "material": "m", "coefficients": { "z": 1 },
      "clip": { "sphere": { "center": [0, 0, 0], "radius": 1 } } })json",
                              chord);
  CHECK(area_of(plane) < kPi);
  CHECK(area_of(plane) > kPi * (1.0 - 2.0 * chord));
  for (const auto& [edge, count] : edges_of(plane)) {
    if (count != 2) CHECK(std::hypot(edge.first[0], edge.first[1]) == Approx(1.0).epsilon(1e-6));
  }
  for (const shared::float4& n : plane.normals) CHECK(n.z > 0.999999F);

  const PatchMesh cone = cut(R"json({ "type": "implicit", "material": "m", "expression": "x^2 + y^2 - z^2/4",
      "clip": { "box": { "min": [-1, -1, -1], "max": [1, 1, 1] } } })json",
                             chord);
  // About the apex, where no normal says how it goes on, as coarse as a cell: a third of the height, a ninth of the
  // area.
  CHECK(std::abs(area_of(cone) / (2.0 * kPi * 0.5 * std::sqrt(1.25)) - 1.0) < 0.05);
}

TEST_CASE("a surface of many parts is cut closed, all of them") {
  // Below -1/2 the sum of three quartics of least value -1/4 each is only near the corners of a cube.
  const PatchMesh eight = cut(R"json({ "type": "implicit", "material": "m",
      "expression": "x^2*(x^2-1) + y^2*(y^2-1) + z^2*(z^2-1) + 0.6",
      "clip": { "box": { "min": [-1.3, -1.3, -1.3], "max": [1.3, 1.3, 1.3] } } })json",
                              0.01);
  CAPTURE(eight.patch_count(), eight.chord_m);
  CHECK(lonely_edges(eight) == 0);
  CHECK(euler_characteristic(eight) == 2 * 8);
}

}  // namespace hemiray
