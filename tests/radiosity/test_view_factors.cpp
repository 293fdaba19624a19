// View factors between areas, and the files they go to.
#include <catch2/catch.hpp>

#include <cstring>
#include <sstream>

#include "host/radiosity/view_factors.hpp"
#include "tests/radiosity/radiosity_bench.hpp"

namespace hemiray {
namespace {

ViewFactors three_areas() {
  ViewFactors f;
  f.names = {"floor", "a, \"b\"", ""};
  f.areas_m2 = {1.0, 2.0, 0.5};
  f.factors = {0.0, 0.5, 0.25, 0.25, 0.0, 0.125, 0.5, 0.5, 0.0};
  f.reciprocity_errors.assign(9, 0.0);
  f.row_sums = {0.75, 0.375, 1.0};
  return f;
}

}  // namespace

TEST_CASE("view factors sum patches by area, fronts alone") {
  // Two patches of area 1 and 3 make a group; the third has area 2.
  PatchMesh mesh;
  mesh.flat.triangles.resize(3);
  mesh.flat.triangle_objects = {0, 1, 2};
  mesh.normals = {{0, 0, 1, 1}, {0, 0, 1, 3}, {0, 0, 1, 2}};
  const FactorGroups groups = groups_by_name(mesh, {"wall", "wall", "roof"});
  REQUIRE(groups.names == std::vector<std::string>{"wall", "roof"});
  std::vector<FactorRow> rows(6);
  rows[0] = {{4, 0.5F}, {5, 0.25F}};  // the roof's front and back
  rows[2] = {{0, 0.125F}, {4, 0.25F}};
  rows[4] = {{0, 0.25F}, {2, 0.5F}};
  const ViewFactors f = view_factors(mesh, groups, rows, {{}, {}, {0.5, 0.25, 1.0}, {}});
  CHECK(f.areas_m2 == std::vector<double>{4.0, 2.0});
  CHECK(f.factors[0] == 3.0 * 0.125 / 4.0);
  CHECK(f.factors[1] == (0.5 + 3.0 * 0.25) / 4.0);
  CHECK(f.factors[2] == 0.75);
  CHECK(f.factors[3] == 0.0);
  REQUIRE(f.errors.size() == 4);
  CHECK((f.errors[2].geometry == 0.25 && f.errors[2].sampling == 0.125 && f.errors[2].visibility == 0.5));
  CHECK(view_factors(mesh, groups, rows).errors.empty());
  CHECK(f.row_sums[0] == f.factors[0] + f.factors[1]);
  CHECK(f.reciprocity_errors[1] == 0.5 * std::abs(1.25 - 1.5) / 4.0);
  CHECK(f.reciprocity_errors[2] == 0.5 * std::abs(1.25 - 1.5) / 2.0);
}

TEST_CASE("view factors are written as CSV, for NumPy and as View3D writes them") {
  ViewFactors f = three_areas();
  const std::string csv = factors_as_csv(f);
  CHECK(csv.rfind("from,to,area_m2,factor,geometry_error,sampling_error,visibility_error,reciprocity_error\n"
                  "floor,floor,1,0,,,,0\nfloor,\"a, \"\"b\"\"\",1,0.5,,,,0\n",
                  0) == 0);
  CHECK(std::count(csv.begin(), csv.end(), '\n') == 10);

  f.errors.assign(9, {1e-5, 2e-4, 3e-3});
  CHECK(factors_as_csv(f).find("\nfloor,floor,1,0,1e-05,0.0002,0.003,0\n") != std::string::npos);

  const std::string npy = factors_as_npy(f);
  REQUIRE(npy.size() == 128 + 9 * sizeof(double));
  CHECK(npy.compare(0, 8, std::string("\x93NUMPY\x01\x00", 8)) == 0);
  CHECK(npy[127] == '\n');
  CHECK(npy.find("'shape': (3, 3)") != std::string::npos);
  double value = 0.0;
  std::memcpy(&value, npy.data() + 128 + 5 * sizeof(double), sizeof value);
  CHECK(value == 0.125);

  std::istringstream view3d(factors_as_view3d(f, {0.9, 0.8, 1.0}, false));
  std::string head;
  std::getline(view3d, head);
  CHECK(head.size() == 30);  // readers take 31 characters for the head
  CHECK(head.rfind("View3D 3.2 0 0 0 3 ", 0) == 0);
  std::vector<double> numbers;
  for (double number = 0.0; view3d >> number;) numbers.push_back(number);
  REQUIRE(numbers.size() == 3 + 9 + 3);
  CHECK(numbers[1] == 2.0);
  CHECK(numbers[3 + 5] == 0.125);
  CHECK(numbers[12] == 0.9);
}

TEST_CASE("View3D's input has every patch, and combines those of an area") {
  FlatScene flat = test::flat_without_materials();
  const std::uint32_t grey = test::add_material(flat, Vec3(0.25F), Vec3(0.0F));
  test::add_quad(flat, Vec3(0.0F), Vec3(1, 0, 0), Vec3(0, 1, 0), grey);
  test::add_quad(flat, Vec3(0, 0, 1), Vec3(0, 1, 0), Vec3(1, 0, 0), grey);
  const PatchMesh mesh = make_patch_mesh(flat, {0.0, 4, 0.0});
  const FactorGroups groups = groups_by_name(mesh, {"big floor", "roof"});
  std::istringstream text(patches_as_view3d(mesh, groups, "two\nplates"));
  std::vector<std::string> surfaces;
  std::size_t vertices = 0;
  for (std::string line; std::getline(text, line);) {
    if (line.rfind("S ", 0) == 0) surfaces.push_back(line);
    vertices += line.rfind("V ", 0) == 0;
    if (line.rfind("T ", 0) == 0) CHECK(line == "T two plates");
  }
  CHECK(vertices == 8);
  REQUIRE(surfaces.size() == 4);
  CHECK(surfaces[0] == "S 1 1 2 3 0 0 0 0.750 big_floor");
  CHECK(surfaces[1] == "S 2 1 3 4 0 0 1 0.750 big_floor");
  CHECK(surfaces[3].find(" 0 0 3 0.750 roof") != std::string::npos);
}

}  // namespace hemiray
