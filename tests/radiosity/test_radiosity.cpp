// A scene's diffuse light as a whole: lights that are no surfaces, power, display.
#include <catch2/catch.hpp>

#include <cmath>
#include <numbers>

#include "host/radiosity/display.hpp"
#include "host/radiosity/radiosity.hpp"
#include "tests/radiosity/radiosity_bench.hpp"

namespace hemiray {
namespace {

using test::RadiosityBench;

shared::Light point_light(Vec3 place, float intensity) {
  shared::Light light{};
  light.kind = HR_LIGHT_POINT;
  light.position = {place.x, place.y, place.z, 0.0F};
  light.intensity = {intensity, intensity, intensity, 0.0F};
  light.samples_u = light.samples_v = light.sample_count = 1;
  return light;
}

// A floor of patches of that edge, half of it under a plate, below a point light.
void check_floor(double edge, double tolerance, std::size_t least_in_light) {
  RadiosityBench bench;
  FlatScene flat = test::flat_without_materials();
  const std::uint32_t grey = test::add_material(flat, Vec3(0.5F), Vec3(0.0F));
  test::add_quad(flat, Vec3(-1, 0, 1), Vec3(2, 0, 0), Vec3(0, 0, -2), grey);  // floor
  test::add_quad(flat, Vec3(0, 1, 2), Vec3(2, 0, 0), Vec3(0, 0, -4), test::add_material(flat, Vec3(0), Vec3(0)));
  flat.lights.push_back(point_light(Vec3(0, 2, 0), 10.0F));
  RadiosityOptions options;
  options.mesh = {edge, 0, 0.0};
  options.factors.method = FormFactors::hemicube;
  options.factors.hemicube.resolution = 8;
  options.residual_samples = 0;
  const Radiosity r = compute_radiosity(bench.context, flat, options);
  std::size_t in_light = 0;
  for (std::uint32_t i = 0; i < r.mesh.patch_count(); i++) {
    if (r.mesh.faces[i] >= 2) continue;
    DVec3 middle(0.0);
    const shared::uint4& t = r.mesh.flat.triangles[i];
    for (const std::uint32_t v : {t.x, t.y, t.z}) middle += DVec3(test::vertex(r.mesh.flat, v)) / 3.0;
    const double r2 = 4.0 + middle.x * middle.x + middle.z * middle.z;
    const double exact = 10.0 * 2.0 / (r2 * std::sqrt(r2));
    const double found = r.irradiance[std::size_t{2} * i][0];
    CHECK(r.irradiance[std::size_t{2} * i + 1][0] == 0.0);
    if (middle.x > 0.1) {
      CHECK(found < 1e-6);  // behind the plate, which is black
    } else if (middle.x < -0.1) {
      in_light++;
      CHECK(std::abs(found - exact) < tolerance * exact);
      CHECK(std::abs(r.solution.radiosity[std::size_t{2} * i][0] - 0.5 * found) < 1e-4);
    }
  }
  CHECK(in_light >= least_in_light);
  CHECK(r.statistics.emitted_w > 0.0);
}

}  // namespace

TEST_CASE("a point light brings I cos / r^2, and none through a plate") {
  check_floor(0.1, 3e-3, 50);  // the mean over a patch of 0.1 m is off by less
}

TEST_CASE("tiny: a point light lights a floor but for what is under a plate") { check_floor(1.5, 0.1, 1); }

TEST_CASE("power: a closed room absorbs what its lamp sends") {
  RadiosityBench bench;
  FlatScene flat = test::flat_without_materials();
  test::add_room(flat, Vec3(2.0F, 1.0F, 1.5F), test::add_material(flat, Vec3(0.8F, 0.5F, 0.1F), Vec3(0.0F)));
  test::add_quad(flat, Vec3(0.8F, 0.9F, 0.5F), Vec3(0.4F, 0, 0), Vec3(0, 0, 0.4F),
                 test::add_material(flat, Vec3(0.0F), Vec3(10.0F)));
  RadiosityOptions options;
  options.mesh.patches = 1000;
  options.solve.tolerance = 1e-7;
  const Radiosity r = compute_radiosity(bench.context, flat, options);
  CHECK(r.statistics.emitted_w == Approx(3.0 * 10.0 * 0.16).epsilon(1e-5));
  // Raw factors are not reciprocal: power is kept to their quantisation.
  CHECK(r.statistics.absorbed_w == Approx(r.statistics.emitted_w).epsilon(0.01));
}

TEST_CASE("light is interpolated on smooth surfaces and not over creases") {
  FlatScene flat = test::flat_without_materials();
  const std::uint32_t grey = test::add_material(flat, Vec3(0.5F), Vec3(0.0F));
  test::add_quad(flat, Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 0, -1), grey);  // floor
  test::add_quad(flat, Vec3(0, 0, -1), Vec3(1, 0, 0), Vec3(0, 1, 0), grey);  // wall behind it
  const PatchMesh mesh = make_patch_mesh(flat, {0.0, 4, 0.0});
  REQUIRE(mesh.patch_count() == 4);
  std::vector<std::array<double, 3>> h(8, {0.0, 0.0, 0.0});
  for (std::size_t i = 0; i < 4; i++) h[2 * i] = {i < 2 ? static_cast<double>(i + 1) : 9.0, 0.0, 0.0};
  const auto smooth = corner_irradiance(mesh, h, {}), flat_shown = corner_irradiance(mesh, h, {false, 20.0});
  for (std::uint32_t i = 0; i < 4; i++) {
    const shared::uint4& t = mesh.flat.triangles[i];
    std::size_t corner = 0;
    for (const std::uint32_t v : {t.x, t.y, t.z}) {
      const float value = smooth[std::size_t{6} * i + corner][0];
      CHECK(flat_shown[std::size_t{6} * i + corner][0] == static_cast<float>(h[std::size_t{2} * i][0]));
      CHECK(smooth[std::size_t{6} * i + 3 + corner][0] == 0.0F);  // backs are dark
      if (i < 2) {
        // Both floor patches meet at the ends of the diagonal only.
        std::size_t users = 0;
        for (std::size_t j = 0; j < 2; j++) {
          const shared::uint4& other = mesh.flat.triangles[j];
          users += other.x == v || other.y == v || other.z == v;
        }
        CHECK(value == (users == 2 ? 1.5F : static_cast<float>(i + 1)));
      } else {
        CHECK(value == 9.0F);
      }
      corner++;
    }
  }
}

}  // namespace hemiray
