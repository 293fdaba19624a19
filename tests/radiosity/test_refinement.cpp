// Adaptive refinement as a whole: at a shadow's boundary, with power kept, the same bits each time.
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "host/base/error.hpp"
#include "host/radiosity/radiosity.hpp"
#include "tests/radiosity/radiosity_bench.hpp"
#include "tests/support/temp_folder.hpp"

namespace hemiray {
namespace {

using test::RadiosityBench;

// A floor of 2 x 2 m in the shadow of a black plate of 0.5 x 0.5 m at 0.5 m, under a lamp of 0.1 x 0.1 m at 1.5 m. The
// plate is turned and off the middle: edges of patches that happen to lie on its shadow's would flatter a mesh.
constexpr double kLamp = 0.1, kLampHeight = 1.5, kPlate = 0.5, kPlateHeight = 0.5, kEmission = 100.0;
constexpr double kTurn = 0.35, kPlateX = 0.06, kPlateZ = -0.04;
constexpr double kThrow = kLampHeight / (kLampHeight - kPlateHeight);  // of the shadow to the plate

// How far (x, z) is from the middle of a turned square around (cx, cz), as a square's own norm has it.
double square_norm(double x, double z, double cx, double cz) {
  const double dx = x - cx, dz = z - cz, c = std::cos(kTurn), s = std::sin(kTurn);
  return std::max(std::abs(c * dx + s * dz), std::abs(c * dz - s * dx));
}

FlatScene shadow_scene() {
  FlatScene flat = test::flat_without_materials();
  const std::uint32_t grey = test::add_material(flat, Vec3(0.5F), Vec3(0.0F)),
                      black = test::add_material(flat, Vec3(0.0F), Vec3(0.0F)),
                      lamp = test::add_material(flat, Vec3(0.0F), Vec3(static_cast<float>(kEmission)));
  test::add_quad(flat, Vec3(-1, 0, 1), Vec3(2, 0, 0), Vec3(0, 0, -2), grey);
  const DVec3 u(kPlate * std::cos(kTurn), 0.0, kPlate * std::sin(kTurn)), v(u.z, 0.0, -u.x);
  test::add_quad(flat, Vec3(DVec3(kPlateX, kPlateHeight, kPlateZ) - 0.5 * (u + v)), Vec3(u), Vec3(v), black);
  test::add_quad(flat, Vec3(-0.5 * kLamp, kLampHeight, -0.5 * kLamp), Vec3(kLamp, 0, 0), Vec3(0, 0, kLamp), lamp);
  return flat;
}

// Irradiance of the floor at (x, 0, z), by points of the lamp: nothing else is lit but it.
double true_irradiance(double x, double z) {
  constexpr int kPoints = 24;
  double sum = 0.0;
  for (int i = 0; i < kPoints * kPoints; i++) {
    const double u = ((i % kPoints + 0.5) / kPoints - 0.5) * kLamp,
                 v = (((i - i % kPoints) / kPoints + 0.5) / kPoints - 0.5) * kLamp;
    const double t = kPlateHeight / kLampHeight, px = x + t * (u - x), pz = z + t * (v - z);
    if (square_norm(px, pz, kPlateX, kPlateZ) < 0.5 * kPlate) continue;
    const double r2 = (u - x) * (u - x) + (v - z) * (v - z) + kLampHeight * kLampHeight;
    sum += kLampHeight * kLampHeight / (r2 * r2);
  }
  return kEmission * kLamp * kLamp / std::numbers::pi * sum / (kPoints * kPoints);
}

Radiosity solved(RadiosityBench& bench, const FlatScene& flat, std::uint32_t patches, std::uint32_t refine,
                 FormFactors method = FormFactors::hybrid) {
  RadiosityOptions options;
  options.mesh.patches = patches;
  options.refine_patches = refine;
  options.factors.method = method;
  options.factors.hemicube.resolution = method == FormFactors::hemicube ? 64 : kReachResolution;
  options.residual_samples = 1024;
  return compute_radiosity(bench.context, flat, options);
}

// Root of the mean square of what the floor's irradiance, constant on each patch, is off by.
double error_of(const Radiosity& r) {
  constexpr int kGrid = 100;
  double squares = 0.0;
  int found = 0;
  for (std::uint32_t i = 0; i < r.mesh.patch_count(); i++) {
    if (r.mesh.faces[i] >= 2) continue;
    const shared::uint4& t = r.mesh.flat.triangles[i];
    const Vec3 a = test::vertex(r.mesh.flat, t.x), b = test::vertex(r.mesh.flat, t.y),
               c = test::vertex(r.mesh.flat, t.z);
    const auto side = [](const Vec3& p, const Vec3& q, double x, double z) {
      return (q.x - p.x) * (z - p.z) - (q.z - p.z) * (x - p.x);
    };
    // Points of the grid, off from where edges are.
    const auto first = [](float w) { return static_cast<int>(std::ceil((w + 1.0) * 0.5 * kGrid - 0.47)); };
    const int x0 = first(std::min({a.x, b.x, c.x})), x1 = first(std::max({a.x, b.x, c.x}));
    const int z0 = first(std::min({a.z, b.z, c.z})), z1 = first(std::max({a.z, b.z, c.z}));
    for (int k = x0; k < x1; k++) {
      for (int l = z0; l < z1; l++) {
        const double x = (k + 0.47) * 2.0 / kGrid - 1.0, z = (l + 0.471) * 2.0 / kGrid - 1.0;
        const double s = side(a, b, x, z), u = side(b, c, x, z), v = side(c, a, x, z);
        if (!((s > 0 && u > 0 && v > 0) || (s < 0 && u < 0 && v < 0))) continue;
        found++;
        const double off = r.irradiance[std::size_t{2} * i][0] - true_irradiance(x, z);
        squares += off * off;
      }
    }
  }
  CHECK(std::abs(found - kGrid * kGrid) < kGrid);
  return std::sqrt(squares / found);
}

bool same_bits(const Radiosity& a, const Radiosity& b) {
  return a.mesh.flat.positions == b.mesh.flat.positions && a.mesh.patch_count() == b.mesh.patch_count() &&
         a.solution.radiosity == b.solution.radiosity && a.irradiance == b.irradiance &&
         a.solution.bounds == b.solution.bounds && a.continuous.rms == b.continuous.rms;
}

FlatScene lit_room() {
  FlatScene flat = test::flat_without_materials();
  test::add_room(flat, Vec3(2.0F, 1.0F, 1.5F), test::add_material(flat, Vec3(0.8F, 0.5F, 0.1F), Vec3(0.0F)));
  test::add_quad(flat, Vec3(0.8F, 0.9F, 0.5F), Vec3(0.4F, 0, 0), Vec3(0, 0, 0.4F),
                 test::add_material(flat, Vec3(0.0F), Vec3(10.0F)));
  return flat;
}

}  // namespace

TEST_CASE("patches are refined at a shadow's boundary, and err less than as many alike ones") {
  RadiosityBench bench;
  const FlatScene flat = shadow_scene();
  const Radiosity refined = solved(bench, flat, 300, 1200), uniform = solved(bench, flat, 1200, 0);
  const RefineReport& report = refined.statistics.refinement;
  REQUIRE(!report.rounds.empty());
  CHECK(refined.mesh.patch_count() <= 1200);
  CHECK(refined.mesh.patch_count() > 1000);
  CHECK(refined.solution.converged);
  double made = 0.0, all = 0.0;
  for (const RefineRound& round : report.rounds) {
    made += static_cast<double>(round.made_rows);
    all += static_cast<double>(round.rows);
  }
  CHECK(made < 0.75 * all);
  const double error = error_of(refined), other = error_of(uniform), before = error_of(solved(bench, flat, 300, 0));
  std::printf("root mean square error of the irradiance: %u patches %.4f, refined to %u %.4f, %u alike %.4f W/m^2\n",
              report.patches, before, refined.mesh.patch_count(), error, uniform.mesh.patch_count(), other);
  CHECK(error < 0.7 * other);
  // What is reported says so, too.
  CHECK(report.rounds.back().jump < 0.5 * report.jump);
  // Of the floor's smallest patches nearly all lie near the boundary, where 15 % of the floor are.
  std::vector<std::pair<float, double>> floor;
  for (std::uint32_t i = 0; i < refined.mesh.patch_count(); i++) {
    if (refined.mesh.faces[i] >= 2) continue;
    const shared::uint4& t = refined.mesh.flat.triangles[i];
    DVec3 middle(0.0);
    for (const std::uint32_t v : {t.x, t.y, t.z}) middle += DVec3(test::vertex(refined.mesh.flat, v)) / 3.0;
    floor.emplace_back(
        refined.mesh.normals[i].w,
        std::abs(square_norm(middle.x, middle.z, kThrow * kPlateX, kThrow * kPlateZ) - 0.5 * kThrow * kPlate));
  }
  std::ranges::sort(floor);
  floor.resize(floor.size() / 2);
  const auto near = std::ranges::count_if(floor, [](const auto& patch) { return patch.second < 0.1; });
  CHECK(static_cast<double>(near) > 0.9 * static_cast<double>(floor.size()));
}

TEST_CASE("a refined room absorbs what its lamp sends, by any form factors, to a bound that holds") {
  RadiosityBench bench;
  for (const FormFactors method : {FormFactors::hybrid, FormFactors::analytic, FormFactors::hemicube}) {
    const Radiosity r = solved(bench, lit_room(), 250, 600, method);
    CAPTURE(static_cast<int>(method), r.mesh.patch_count());
    CHECK(r.mesh.patch_count() > 500);
    CHECK(r.solution.history.back().bound <= 1e-4 * r.solution.largest);
    CHECK(r.statistics.emitted_w == Approx(3.0 * 10.0 * 0.16).epsilon(1e-5));
    // Pair by pair to what the solution's tolerance leaves, hemicubes to their quantisation.
    const double tolerance = method == FormFactors::hybrid ? 1e-3 : 0.02;
    CHECK(r.statistics.absorbed_w == Approx(r.statistics.emitted_w).epsilon(tolerance));
    CHECK(r.continuous.rms_high < r.statistics.refinement.continuous.rms_low);
  }
}

TEST_CASE("refinement gives the same bits again, and from a file that has the solution before") {
  RadiosityBench bench;
  const FlatScene flat = lit_room();
  RadiosityOptions options;
  options.mesh.patches = 120;
  options.refine_patches = 250;
  options.residual_samples = 64;
  const test::TempFolder folder;
  const Radiosity whole = compute_radiosity(bench.context, flat, options);
  CHECK(whole.mesh.patch_count() > 200);
  CHECK(same_bits(compute_radiosity(bench.context, flat, options), whole));
  options.keep.file = (folder / "a.solution").string();
  RadiosityOptions stopped = options, coarse = options;
  int calls = 0;
  stopped.on_progress = [&](const std::string& step, double) { return step != "refinement" || ++calls < 3; };
  const Radiosity part = compute_radiosity(bench.context, flat, stopped);
  CHECK(part.statistics.interrupted);
  CHECK(part.statistics.refinement.end == "interrupted");
  CHECK(part.mesh.patch_count() < whole.mesh.patch_count());
  CHECK(part.solution.radiosity.size() == part.mesh.side_count());
  options.keep.resume = coarse.keep.resume = true;
  CHECK(same_bits(compute_radiosity(bench.context, flat, options), whole));
  coarse.refine_patches = 0;
  CHECK(compute_radiosity(bench.context, flat, coarse).mesh.patch_count() == whole.statistics.refinement.patches);
}

TEST_CASE("where light does not vary nothing is refined, and what cannot be is refused") {
  RadiosityBench bench;
  FlatScene furnace = test::flat_without_materials();
  test::add_room(furnace, Vec3(1.0F, 2.0F, 1.5F), test::add_material(furnace, Vec3(0.5F), Vec3(1.0F)));
  const Radiosity r = solved(bench, furnace, 100, 400, FormFactors::hemicube);
  CHECK(r.statistics.refinement.rounds.empty());
  CHECK_THAT(r.statistics.refinement.end, Catch::Contains("neighbours differ by"));
  CHECK_THROWS_AS(solved(bench, lit_room(), 400, 200), InputError);
  RadiosityOptions options;
  options.mesh.patches = 200;
  options.refine_patches = 400;
  options.factor_bytes = 20000;
  CHECK_THROWS_AS(compute_radiosity(bench.context, lit_room(), options), InputError);
}

}  // namespace hemiray
