// The patch mesh: areas are kept, edges shared, budgets and errors as stated.
#include <catch2/catch.hpp>

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "host/base/error.hpp"
#include "host/scene/load.hpp"
#include "tests/radiosity/radiosity_bench.hpp"
#include "tests/support/temp_folder.hpp"

namespace hemiray {
namespace {

using test::area_of;
using test::lonely_edges;
using test::TempFolder;

}  // namespace

TEST_CASE("a patch mesh keeps areas and has no T-junctions") {
  FlatScene flat = test::flat_without_materials();
  test::add_room(flat, Vec3(1.0F, 3.0F, 0.7F), test::add_material(flat, Vec3(0.5F), Vec3(0.0F)));
  for (const std::uint32_t budget : {12U, 100U, 2000U}) {
    const PatchMesh mesh = make_patch_mesh(flat, {0.0, budget, 0.0});
    CHECK(mesh.patch_count() <= budget);
    CHECK(mesh.patch_count() > budget / 3);
    CHECK(std::abs(area_of(mesh) - 2.0 * (3.0 + 0.7 + 2.1)) < 1e-5);
    CHECK(lonely_edges(mesh) == 0);
  }
  const PatchMesh mesh = make_patch_mesh(flat, {0.25, 0, 0.0});
  CHECK(mesh.edge_m <= 0.25);
  CHECK(lonely_edges(mesh) == 0);
}

TEST_CASE("a sphere is cut to the stated distance, closed") {
  FlatScene flat = test::flat_without_materials();
  test::add_material(flat, Vec3(0.5F), Vec3(0.0F));
  test::add_sphere(flat, Vec3(1.0F, 2.0F, 3.0F), 2.0F);
  for (const double chord : {0.1, 0.01, 0.001}) {
    const PatchMesh mesh = make_patch_mesh(flat, {100.0, 0, chord});
    INFO(mesh.patch_count() << " patches, " << mesh.chord_m);
    CHECK(mesh.chord_m <= chord);
    CHECK(mesh.chord_m > chord / 8.0);
    CHECK(lonely_edges(mesh) == 0);
    const double exact = 16.0 * std::numbers::pi;
    CHECK(area_of(mesh) < exact);
    CHECK(area_of(mesh) > exact * (1.0 - 2.0 * chord));
  }
}

TEST_CASE("disks, cylinders and cones are cut to the stated distance, closed where they are") {
  const auto shape_scene = [](const char* json) {
    const TempFolder folder;
    const std::string text =
        fmt::format(R"({{ "hemiray": 1, "materials": {{ "m": {{ "kd": 0.5 }} }}, "objects": [ {} ] }})", json);
    return flatten_scene(load_scene(folder.write("s.json", text)));
  };
  struct Expected {
    const char* json;
    double area;
    bool closed;
  };
  constexpr double kPi = std::numbers::pi;
  const Expected shapes[] = {
      {R"({ "type": "disk", "material": "m", "center": [1, 2, 3], "normal": [1, 1, 0], "radius": 2 })", 4.0 * kPi,
       false},
      {R"({ "type": "cylinder", "material": "m", "from": [0, 0, 0], "to": [0, 3, 1], "radius": 1 })",
       2.0 * kPi + 2.0 * kPi * std::sqrt(10.0), true},
      {R"({ "type": "cone", "material": "m", "from": [0, 0, 0], "to": [0, 4, 0], "radius_from": 3 })",
       9.0 * kPi + 15.0 * kPi, true},
      {R"({ "type": "cone", "material": "m", "from": [0, 0, 0], "to": [0, 4, 0], "radius_from": 6, "radius_to": 3, "caps": false })",
       kPi * 9.0 * 5.0, false},
  };
  for (const Expected& shape : shapes) {
    const FlatScene flat = shape_scene(shape.json);
    for (const double chord : {0.05, 0.005}) {
      const PatchMesh mesh = make_patch_mesh(flat, {100.0, 0, chord});
      INFO(shape.json << ": " << mesh.patch_count() << " patches, " << mesh.chord_m);
      CHECK(mesh.chord_m <= chord);
      CHECK(area_of(mesh) < shape.area * 1.000001);
      CHECK(area_of(mesh) > shape.area * (1.0 - 2.0 * chord));
      CHECK((lonely_edges(mesh) == 0) == shape.closed);
    }
    const PatchMesh fine = make_patch_mesh(flat, {0.3, 0, 0.0});
    CHECK(fine.edge_m <= 0.3);
    CHECK((lonely_edges(fine) == 0) == shape.closed);
  }
}

TEST_CASE("what cannot be cut, and mirrors of light, are refused") {
  FlatScene flat = test::flat_without_materials();
  test::add_material(flat, Vec3(0.5F), Vec3(0.0F));
  CHECK_THROWS_AS(make_patch_mesh(flat, {}), InputError);
  test::add_plane(flat, Vec3(0.0F), Vec3(0.0F, 1.0F, 0.0F));
  CHECK_THROWS_AS(make_patch_mesh(flat, {}), InputError);
  flat.planes.clear();
  test::add_quad(flat, Vec3(0.0F), Vec3(1, 0, 0), Vec3(0, 1, 0), test::add_material(flat, Vec3(1.0F), Vec3(0.0F)));
  CHECK_THROWS_AS(make_patch_mesh(flat, {}), InputError);
}

}  // namespace hemiray
