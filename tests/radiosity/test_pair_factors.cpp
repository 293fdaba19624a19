// Pairs with nothing in the way, against cubature in long double and closed forms.
#include <catch2/catch.hpp>

#include <cmath>
#include <cstdlib>
#include <map>
#include <numbers>
#include <random>

#include "tests/radiosity/pair_bench.hpp"

namespace hemiray {
namespace {

using test::RadiosityBench;

void add_triangle(FlatScene& flat, const std::array<Vec3, 3>& t) {
  const std::uint32_t a = test::add_vertex(flat, t[0]), b = test::add_vertex(flat, t[1]),
                      c = test::add_vertex(flat, t[2]);
  const auto object = static_cast<std::uint32_t>(flat.triangle_objects.size());
  flat.triangles.push_back({a, b, c, 0});
  flat.triangle_objects.push_back(object);
}

double value_at(const FactorRow& row, std::uint32_t column) {
  for (const auto& [side, value] : row) {
    if (side == column) return static_cast<double>(value);
  }
  return 0.0;
}

void check_symmetric(const std::vector<FactorRow>& rows) {
  std::size_t differ = 0, pairs = 0;
  for (std::uint32_t i = 0; i < rows.size(); i++) {
    for (const auto& [j, value] : rows[i]) {
      pairs++;
      differ += value_at(rows[j], i) != static_cast<double>(value);
    }
  }
  CHECK(pairs > 0);
  CHECK(differ == 0);
}

}  // namespace

TEST_CASE("pairs of any size, tilt and distance are as cubature says, and symmetric to the bit") {
  RadiosityBench bench;
  std::mt19937 random(20240607);
  std::uniform_real_distribution<float> unit(-1.0F, 1.0F);
  const auto somewhere = [&] { return Vec3(unit(random), unit(random), unit(random)); };
  std::map<int, double> worst;  // by distance over the radii, in halvings
  std::size_t many = 0;
  for (int set = 0; set < 12; set++) {
    FlatScene flat = test::flat_without_materials();
    test::add_material(flat, Vec3(0.5F), Vec3(0.0F));
    for (int k = 0; k < 8; k++) {
      const Vec3 center = somewhere() * 2.0F;
      const float size = std::exp2(-1.5F + 1.5F * unit(random)) * (set % 4 == 0 ? 0.1F : 1.0F);
      add_triangle(flat, {center + somewhere() * size, center + somewhere() * size, center + somewhere() * size});
    }
    const PatchMesh mesh = make_patch_mesh(flat, {100.0, 0, 0.0});
    const std::vector<FactorRow> rows = test::unobstructed_exchange(bench, mesh);
    check_symmetric(rows);
    for (std::uint32_t i = 0; i < mesh.patch_count(); i++) {
      for (std::uint32_t j = i + 1; j < mesh.patch_count(); j++) {
        const reference::Corners a = test::corners_of(mesh, 2 * i), b = test::corners_of(mesh, 2 * j);
        const auto exact = static_cast<double>(reference::exchange_area(a, b, 1e-7L));
        const double got = value_at(rows[std::size_t{2} * i], 2 * j);
        const double area = static_cast<double>(std::min(mesh.normals[i].w, mesh.normals[j].w));
        INFO("set " << set << ", pair " << i << ", " << j << ": " << got << ", not " << exact);
        CHECK(std::abs(got - exact) <= HR_PAIR_FAR_ERROR * exact + 1e-7 * area);
        many += exact > 0.0;
        const auto center = [](const reference::Corners& t) {
          return DVec3(static_cast<double>(t[0].x + t[1].x + t[2].x) / 3,
                       static_cast<double>(t[0].y + t[1].y + t[2].y) / 3,
                       static_cast<double>(t[0].z + t[1].z + t[2].z) / 3);
        };
        double ra = 0, rb = 0;
        for (std::size_t k = 0; k < 3; k++) {
          const auto at = [](const reference::Point& p) {
            return DVec3(static_cast<double>(p.x), static_cast<double>(p.y), static_cast<double>(p.z));
          };
          ra = std::max(ra, glm::length(at(a[k]) - center(a)));
          rb = std::max(rb, glm::length(at(b[k]) - center(b)));
        }
        const int bin = static_cast<int>(std::floor(2.0 * std::log2(glm::length(center(a) - center(b)) / (ra + rb))));
        if (exact > 1e-4 * area) worst[bin] = std::max(worst[bin], std::abs(got - exact) / exact);
      }
    }
  }
  CHECK(many > 60);
  if (std::getenv("HEMIRAY_PRINT") != nullptr) {
    for (const auto& [bin, error] : worst) std::printf("distance %.2f radii: %.2g\n", std::exp2(0.5 * bin), error);
  }
}

TEST_CASE("tiny: two triangles exchange what cubature says") {
  RadiosityBench bench;
  FlatScene flat = test::flat_without_materials();
  test::add_material(flat, Vec3(0.5F), Vec3(0.0F));
  add_triangle(flat, {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)});
  add_triangle(flat, {Vec3(0, 0, 0), Vec3(0, 0, 1), Vec3(1, 0, 0)});  // touches the first
  add_triangle(flat, {Vec3(0, 0, 5), Vec3(0, 1, 5), Vec3(1, 0, 5)});
  add_triangle(flat, {Vec3(0, 0, 25), Vec3(0, 1, 25), Vec3(1, 0, 25)});
  const PatchMesh mesh = make_patch_mesh(flat, {100.0, 0, 0.0});
  const std::vector<FactorRow> rows = test::unobstructed_exchange(bench, mesh);
  for (std::uint32_t i = 0; i < 4; i++) {
    for (std::uint32_t j = 0; j < 4; j++) {
      if (i == j) continue;
      const auto exact = static_cast<double>(
          reference::exchange_area(test::corners_of(mesh, 2 * i), test::corners_of(mesh, 2 * j), 1e-7L));
      INFO(i << ", " << j << ": " << value_at(rows[std::size_t{2} * i], 2 * j) << ", not " << exact);
      CHECK(std::abs(value_at(rows[std::size_t{2} * i], 2 * j) - exact) <= HR_PAIR_FAR_ERROR * exact + 1e-7);
    }
  }
}

TEST_CASE("rectangles that share an edge, or face each other, have their closed forms' factors") {
  RadiosityBench bench;
  // Two squares that share an edge, by angle: Howell's catalogue, C-16, by its own integral done in long double here.
  for (const double degrees : {30.0, 60.0, 90.0, 120.0, 150.0}) {
    FlatScene flat = test::flat_without_materials();
    test::add_material(flat, Vec3(0.5F), Vec3(0.0F));
    const double angle = degrees * std::numbers::pi / 180.0;
    test::add_quad(flat, Vec3(0), Vec3(1, 0, 0), Vec3(0, 1, 0), 0);
    const Vec3 up(0.0F, static_cast<float>(std::cos(angle)), static_cast<float>(std::sin(angle)));
    test::add_quad(flat, Vec3(0), up, Vec3(1, 0, 0), 0);
    for (const std::uint32_t patches : {4U, 200U}) {
      const PatchMesh mesh = make_patch_mesh(flat, {0.0, patches, 0.0});
      const std::vector<FactorRow> rows = test::unobstructed_exchange(bench, mesh);
      double got = 0.0;
      for (std::uint32_t i = 0; i < mesh.patch_count(); i++) {
        if (mesh.faces[i] >= 2) continue;
        for (const auto& [j, value] : rows[std::size_t{2} * i]) got += static_cast<double>(value);
      }
      // F = 1 - the crossed strings' complement has no short form at finite length: integrate the point factors.
      const PatchMesh whole = make_patch_mesh(flat, {100.0, 0, 0.0});
      double exact = 0.0;
      for (std::uint32_t i = 0; i < 2; i++) {
        for (std::uint32_t j = 2; j < 4; j++) {
          exact += static_cast<double>(
              reference::exchange_area(test::corners_of(whole, 2 * i), test::corners_of(whole, 2 * j), 1e-7L));
        }
      }
      INFO(degrees << " degrees, " << mesh.patch_count() << " patches");
      CHECK(std::abs(got - exact) < 1e-5 * exact);
      if (degrees == 90.0) CHECK(std::abs(got - 0.200043776) < 1e-5 * 0.2);
    }
  }
}

}  // namespace hemiray
