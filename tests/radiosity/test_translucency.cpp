// Translucent sheets: what arrives on one side leaves the other one.
#include <catch2/catch.hpp>

#include <cmath>

#include "host/radiosity/radiosity.hpp"
#include "tests/radiosity/radiosity_bench.hpp"

namespace hemiray {
namespace {

using test::RadiosityBench;

// What the two rooms are made of: E [W/m^2] of walls and of the sheet's front, which is in the first room.
struct TwoRooms {
  Vec3 first, second, sheet;
  Vec3 tau;
};

constexpr float kWall = 0.5F, kSheet = 0.3F;  // reflectances

// Closed cubes side by side that share the sheet at x = 1, fronts inside.
FlatScene two_rooms(const TwoRooms& rooms) {
  FlatScene flat = test::flat_without_materials();
  const std::uint32_t first = test::add_material(flat, Vec3(kWall), rooms.first),
                      second = test::add_material(flat, Vec3(kWall), rooms.second),
                      sheet = test::add_material(flat, Vec3(kSheet), rooms.sheet);
  shared::Material& m = flat.materials[sheet];
  m.translucency_r = rooms.tau.x;
  m.translucency_g = rooms.tau.y;
  m.translucency_b = rooms.tau.z;
  const Vec3 x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
  for (const Vec3& o : {Vec3(0), x}) {
    const std::uint32_t wall = o == x ? second : first;
    test::add_quad(flat, o, z, x, wall);
    test::add_quad(flat, o + y, x, z, wall);
    test::add_quad(flat, o, x, y, wall);
    test::add_quad(flat, o + z, y, x, wall);
  }
  test::add_quad(flat, Vec3(0), y, z, first);
  test::add_quad(flat, x + x, z, y, second);
  test::add_quad(flat, x, z, y, sheet);
  return flat;
}

Radiosity solved(RadiosityBench& bench, const FlatScene& flat, FormFactors method) {
  RadiosityOptions options;
  options.mesh.patches = 200;
  options.factors.method = method;
  options.factors.hemicube.resolution = 16;
  options.solve.tolerance = 1e-6;
  options.residual_samples = 0;
  return compute_radiosity(bench.context, flat, options);
}

}  // namespace

// In a closed room whose surfaces all send B, B arrives everywhere. So with B and B' in the two rooms: walls
// B = E + rho B, the sheet's front B = E_s + rho_s B + tau B', its back B' = rho_s B' + tau B.
TEST_CASE("two rooms that share a translucent wall have the radiosities of the closed form") {
  RadiosityBench bench;
  const Vec3 tau(0.4F, 0.2F, 0.0F), b(10.0F, 5.0F, 8.0F);
  const Vec3 other = tau * b / (1.0F - kSheet);
  const FlatScene flat =
      two_rooms({b * (1.0F - kWall), other * (1.0F - kWall), b * (1.0F - kSheet) - tau * other, tau});
  for (const FormFactors method : {FormFactors::hemicube, FormFactors::hybrid}) {
    const Radiosity r = solved(bench, flat, method);
    REQUIRE(r.solution.converged);
    const std::uint32_t sheet = flat.triangle_objects.back();
    double worst = 0.0;
    for (std::uint32_t i = 0; i < r.mesh.patch_count(); i++) {
      const std::uint32_t object = r.mesh.flat.triangle_objects[i];
      const bool in_second = (object >= 4 && object < 8) || object == 9;
      for (std::size_t c = 0; c < 3; c++) {
        const auto k = static_cast<glm::length_t>(c);
        const auto front = static_cast<double>(in_second ? other[k] : b[k]);
        worst = std::max(worst, std::abs(r.solution.radiosity[std::size_t{2} * i][c] - front));
        if (object != sheet) continue;
        worst =
            std::max(worst, std::abs(r.solution.radiosity[std::size_t{2} * i + 1][c] - static_cast<double>(other[k])));
      }
    }
    // Rows sum to one within 1e-5 where they are closed, here amplified at most by 1 / (1 - 0.7).
    CAPTURE(static_cast<int>(method), worst);
    CHECK(worst < 1e-3 * 10.0);
  }
}

TEST_CASE("light reaches a room only through its translucent wall, and none gets lost") {
  RadiosityBench bench;
  for (const bool by_point : {false, true}) {
    FlatScene flat = two_rooms({by_point ? Vec3(0.0F) : Vec3(1.0F), Vec3(0.0F), Vec3(0.0F), Vec3(0.5F, 0.25F, 0.0F)});
    if (by_point) {
      shared::Light light{};
      light.kind = HR_LIGHT_POINT;
      light.position = {0.5F, 0.5F, 0.5F, 0.0F};
      light.intensity = {1.0F, 1.0F, 1.0F, 0.0F};
      light.samples_u = light.samples_v = light.sample_count = 1;
      flat.lights.push_back(light);
    }
    const Radiosity r = solved(bench, flat, FormFactors::hybrid);
    REQUIRE(r.solution.converged);
    const double sent = r.statistics.emitted_w, absorbed = r.statistics.absorbed_w;
    CAPTURE(by_point, sent, absorbed);
    CHECK(std::abs(absorbed - sent) < 1e-4 * sent);
    // The far wall's light has the sheet's colour; the last colour does not pass.
    double red = 0.0, green = 0.0, blue = 0.0;
    for (std::uint32_t i = 0; i < r.mesh.patch_count(); i++) {
      if (r.mesh.flat.triangle_objects[i] != 9) continue;
      red += r.irradiance[std::size_t{2} * i][0];
      green += r.irradiance[std::size_t{2} * i][1];
      blue += r.irradiance[std::size_t{2} * i][2];
    }
    CHECK(red > 1.5 * green);
    CHECK(green > 0.0);
    CHECK(blue == 0.0);
  }
  const Radiosity dark =
      solved(bench, two_rooms({Vec3(1.0F), Vec3(0.0F), Vec3(0.0F), Vec3(0.0F)}), FormFactors::hybrid);
  for (std::uint32_t i = 0; i < dark.mesh.patch_count(); i++) {
    if (dark.mesh.flat.triangle_objects[i] == 9) CHECK(dark.irradiance[std::size_t{2} * i][0] == 0.0);
  }
}

}  // namespace hemiray
