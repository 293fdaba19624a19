// Hemicube form factors against closed forms.
#include <catch2/catch.hpp>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <numbers>

#include "host/base/error.hpp"
#include "host/radiosity/hemicube_cells.hpp"
#include "tests/radiosity/pair_bench.hpp"

namespace hemiray {
namespace {

using test::RadiosityBench;

double sum_of(const std::vector<FactorRow>& rows, std::uint32_t side) {
  double sum = 0.0;
  for (const auto& [column, value] : rows[side]) sum += static_cast<double>(value);
  return sum;
}

DVec3 at(const reference::Point& p) {
  return {static_cast<double>(p.x), static_cast<double>(p.y), static_cast<double>(p.z)};
}

// How much a hemicube's factor to a triangle may be off: a direction is taken for another's only if the middle of its
// cell lies across an edge, and that is half a cell's diagonal away at most, seen from `eye`.
double quantisation_bound(const DVec3& eye, const reference::Corners& t, std::uint32_t resolution) {
  const double reach = std::numbers::sqrt2 / resolution;
  double perimeter = 0.0;
  for (std::size_t k = 0; k < 3; k++) {
    const DVec3 a = at(t[k]) - eye, b = at(t[(k + 1) % 3]) - eye;
    perimeter += std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
  }
  return reach * perimeter / std::numbers::pi + reach * reach;
}

}  // namespace

TEST_CASE("cells of a hemicube sum to one, and the middle one is known") {
  for (const std::uint32_t n : {8U, 10U, 64U, 1024U}) {
    const std::vector<double> cells = hemicube_cells(n);
    REQUIRE(cells.size() == std::size_t{n} * n * 3 / 2);
    double top = 0.0, face = 0.0;
    for (std::size_t i = 0; i < cells.size(); i++) (i < std::size_t{n} * n ? top : face) += cells[i];
    // The top: four corners of the catalogue's B-3 at x = y = 1.
    CHECK(std::abs(top + 4.0 * face - 1.0) < 1e-12);
    CHECK(std::abs(top - 4.0 * std::numbers::inv_pi * std::sqrt(0.5) * std::atan(std::sqrt(0.5))) < 1e-12);
  }
}

TEST_CASE("tiny: hemicubes in a closed room see everything once") {
  RadiosityBench bench;
  FlatScene flat = test::flat_without_materials();
  test::add_room(flat, Vec3(1.0F, 2.0F, 1.5F), test::add_material(flat, Vec3(0.5F), Vec3(0.0F)));
  const PatchMesh mesh = make_patch_mesh(flat, {0.0, 12, 0.0});
  for (const std::uint32_t resolution : {8U, 10U}) {
    HemicubeOptions options;
    options.resolution = resolution;
    options.divisions = 2;
    options.jittered = resolution == 10;
    const std::vector<FactorRow> rows = read_rows(test::factors_of_fronts(bench, mesh, options));
    for (std::uint32_t i = 0; i < mesh.patch_count(); i++) {
      INFO("patch " << i << ", resolution " << resolution);
      CHECK(std::abs(sum_of(rows, 2 * i) - 1.0) < 1e-6);
      for (const auto& [side, value] : rows[std::size_t{2} * i]) {
        CHECK(side % 2 == 0);
        CHECK(side / 2 != i);
        CHECK(value > 0.0F);
      }
    }
  }
}

TEST_CASE("hemicubes give the unit cube's factors, the better the more points a face has") {
  RadiosityBench bench;
  FlatScene flat = test::flat_without_materials();
  test::add_room(flat, Vec3(1.0F), test::add_material(flat, Vec3(0.5F), Vec3(0.0F)));
  const CubeView view = GENERATE(CubeView::rays, CubeView::raster);
  const auto opposite = [&](std::uint32_t patches, std::uint32_t divisions) {
    const PatchMesh mesh = make_patch_mesh(flat, {0.0, patches, 0.0});
    HemicubeOptions options;
    options.view = view;
    options.divisions = divisions;
    options.resolution = 64;
    const std::vector<FactorRow> rows = read_rows(test::factors_of_fronts(bench, mesh, options));
    return test::area_factor(
        mesh, rows, [](std::uint32_t face) { return face / 2 == 4; }, [](std::uint32_t face) { return face / 2 == 5; });
  };
  constexpr double kExact = 0.199824896;  // Howell's catalogue, C-11
  const double coarse = std::abs(opposite(12, 1) - kExact), fine = std::abs(opposite(12, 2) - kExact),
               finer = std::abs(opposite(12, 4) - kExact), many = std::abs(opposite(3000, 1) - kExact);
  CAPTURE(coarse, fine, finer, many);
  CHECK(fine < coarse / 2.0);
  CHECK(finer < fine / 2.0);
  CHECK(coarse > 0.01);  // two points a face
  CHECK(finer < 0.002);
  CHECK(many < 0.0005);
}

TEST_CASE("a hemicube sees triangles as Lambert's formula says, up to its cells along their edges") {
  RadiosityBench bench;
  FlatScene flat = test::flat_without_materials();
  test::add_room(flat, Vec3(1.0F, 2.0F, 1.5F), test::add_material(flat, Vec3(0.5F), Vec3(0.0F)));
  const PatchMesh mesh = make_patch_mesh(flat, {100.0, 0, 0.0});
  std::vector<double> errors;
  for (const std::uint32_t resolution : {32U, 128U, 512U}) {
    HemicubeOptions options;
    options.resolution = resolution;
    const std::vector<FactorRow> rows = read_rows(test::factors_of_fronts(bench, mesh, options));
    double squares = 0.0;
    for (std::uint32_t i = 0; i < mesh.patch_count(); i++) {
      const reference::Corners own = test::corners_of(mesh, 2 * i);
      const DVec3 eye = (at(own[0]) + at(own[1]) + at(own[2])) / 3.0;
      const shared::float4& n = mesh.normals[i];
      std::vector<double> seen(mesh.patch_count(), 0.0);
      for (const auto& [side, value] : rows[std::size_t{2} * i]) seen[side / 2] += static_cast<double>(value);
      for (std::uint32_t j = 0; j < mesh.patch_count(); j++) {
        const reference::Corners other = test::corners_of(mesh, 2 * j);
        const auto exact = static_cast<double>(reference::point_factor({eye.x, eye.y, eye.z}, {n.x, n.y, n.z}, other));
        const double error = std::abs(seen[j] - exact);
        INFO("resolution " << resolution << ", patch " << i << " to " << j << ": " << seen[j] << ", not " << exact);
        CHECK(error <= quantisation_bound(eye, other, resolution));
        squares += error * error;
      }
    }
    errors.push_back(std::sqrt(squares / std::pow(mesh.patch_count(), 2.0)));
  }
  CAPTURE(errors);
  if (std::getenv("HEMIRAY_PRINT") != nullptr) std::printf("errors %.2e %.2e %.2e\n", errors[0], errors[1], errors[2]);
  CHECK(errors[1] < errors[0] / 4.0);  // at least with the cells' width
  CHECK(errors[2] < errors[1] / 4.0);
  CHECK(errors[0] > 1e-5);
}

TEST_CASE("hemicube options out of range are refused") {
  HemicubeOptions options;
  options.resolution = 9;
  CHECK_THROWS_AS(check_hemicube_options(options), InputError);
  options.resolution = 1026;
  CHECK_THROWS_AS(check_hemicube_options(options), InputError);
  options.resolution = 64;
  options.divisions = 0;
  CHECK_THROWS_AS(check_hemicube_options(options), InputError);
  options.divisions = 1;
  options.jittered = true;
  CHECK_NOTHROW(check_hemicube_options(options));
  options.view = CubeView::raster;
  CHECK_THROWS_AS(check_hemicube_options(options), InputError);
}

}  // namespace hemiray
