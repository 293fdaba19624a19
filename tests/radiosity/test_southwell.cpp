// Progressive shooting: where the textbook loop goes wrong, and what it may be used for before it has converged.
#include <catch2/catch.hpp>

#include <cmath>
#include <numeric>

#include "host/base/error.hpp"
#include "tests/radiosity/radiosity_bench.hpp"
#include "tests/radiosity/synthetic_system.hpp"

namespace hemiray {
namespace {

using test::RadiosityBench;

PatchMesh three_patches() {
  return test::synthetic_mesh({{1.0F, {0.5F, 0.5F, 0.5F}, {1.0F, 0.0F, 0.0F}},
                               {9.0F, {0.75F, 0.75F, 0.75F}, {0.5F, 0.5F, 0.0F}},
                               {0.25F, {0.25F, 0.25F, 0.25F}, {0.0F, 0.0F, 4.0F}}});
}

// The loop as printed, on the fronts' first colour: what is off by a trap is told by the arguments.
std::vector<double> shoot(const PatchMesh& mesh, const std::vector<FactorRow>& rows, bool clears, bool takes_column,
                          int shots) {
  const std::size_t n = mesh.patch_count();
  std::vector<std::vector<double>> f(n, std::vector<double>(n, 0.0));
  for (std::size_t i = 0; i < n; i++) {
    for (const auto& [k, value] : rows[2 * i]) f[i][k / 2] = static_cast<double>(value);
  }
  std::vector<double> b(n, 0.0), e(n);
  for (std::size_t i = 0; i < n; i++) e[i] = static_cast<double>(mesh.emission[2 * i].x);
  for (int shot = 0; shot < shots; shot++) {
    std::size_t i = 0;
    for (std::size_t k = 1; k < n; k++) {
      if (std::abs(e[k]) > std::abs(e[i])) i = k;
    }
    const double sent = e[i] / (1.0 - static_cast<double>(mesh.reflectance[2 * i].x) * f[i][i]);
    b[i] += sent;
    if (clears) e[i] = 0.0;
    for (std::size_t k = 0; k < n; k++) {
      if (clears && k == i) continue;
      const double ratio = static_cast<double>(mesh.normals[i].w) / static_cast<double>(mesh.normals[k].w);
      e[k] += static_cast<double>(mesh.reflectance[2 * k].x) * (takes_column ? f[i][k] * ratio : f[i][k]) * sent;
    }
  }
  return b;
}

Solution solve_southwell(RadiosityBench& bench, const PatchMesh& mesh, const FactorMatrix& matrix,
                         const SolveOptions& base) {
  SolveOptions options = base;
  options.kind = SolverKind::southwell;
  return solve_radiosity(bench.context, mesh, matrix, options);
}

}  // namespace

TEST_CASE("tiny: southwell clears what it shoots and takes columns, where the textbook's loop does not") {
  RadiosityBench bench;
  const PatchMesh mesh = three_patches();
  const std::vector<FactorRow> rows = test::sphere_rows(mesh);  // F_ii != 0, areas unlike
  const std::vector<double> exact = test::eliminate(mesh, rows, 0);
  const auto error = [&](const auto& of_patch) {
    double worst = 0.0;
    for (std::size_t i = 0; i < mesh.patch_count(); i++) worst = std::max(worst, std::abs(of_patch(i) - exact[2 * i]));
    return worst;
  };
  const auto loop_error = [&](bool clears, bool takes_column) {
    const std::vector<double> b = shoot(mesh, rows, clears, takes_column, 200);
    return error([&b](std::size_t i) { return b[i]; });
  };
  REQUIRE(loop_error(true, true) < 1e-6);
  CHECK_FALSE(loop_error(false, true) < 1.0);   // trap (a): e_i keeps what was sent
  CHECK_FALSE(loop_error(true, false) < 0.05);  // trap (b): row i in place of column i
  for (const ShotPick pick : {ShotPick::power, ShotPick::residual}) {
    for (const std::uint32_t shots : {1U, 2U, 32U}) {
      SolveOptions options;
      options.tolerance = 1e-9;
      options.shots = shots;
      options.pick = pick;
      const Solution solution = solve_southwell(bench, mesh, test::matrix_of(bench.context, rows, 1), options);
      REQUIRE(solution.converged);
      CHECK(error([&](std::size_t i) { return solution.radiosity[2 * i][0]; }) < 1e-6);
    }
  }
}

TEST_CASE("shooting by power gets further with as many shots as shooting by residual") {
  RadiosityBench bench;
  // Bright specks and one large, dimmer wall: trap (c) shoots the specks first.
  std::vector<test::SyntheticPatch> patches(20, {0.001F, {0.5F, 0.5F, 0.5F}, {2.0F, 2.0F, 2.0F}});
  patches.push_back({1.0F, {0.5F, 0.5F, 0.5F}, {1.0F, 1.0F, 1.0F}});
  patches.push_back({1.0F, {0.5F, 0.5F, 0.5F}, {0.0F, 0.0F, 0.0F}});
  const PatchMesh mesh = test::synthetic_mesh(patches);
  const FactorMatrix matrix = test::matrix_of(bench.context, test::sphere_rows(mesh));
  SolveOptions options;
  options.shots = 1;
  options.iterations = 4;
  const auto arrived = [&](ShotPick pick) {
    options.pick = pick;
    return solve_southwell(bench, mesh, matrix, options).irradiance[2 * 21][0];
  };
  CHECK(arrived(ShotPick::power) > 10.0 * arrived(ShotPick::residual));
}

TEST_CASE("unshot light lifts the display to the right mean, and is gone once converged") {
  RadiosityBench bench;
  const PatchMesh mesh = test::synthetic_mesh({{1.0F, {0.0F, 0.0F, 0.0F}, {4.0F, 4.0F, 4.0F}},
                                               {2.0F, {0.5F, 0.75F, 0.5F}, {0.0F, 0.0F, 0.0F}},
                                               {5.0F, {0.5F, 0.75F, 0.5F}, {0.0F, 0.0F, 0.0F}}});
  const FactorMatrix matrix = test::matrix_of(bench.context, test::sphere_rows(mesh));
  SolveOptions options;
  options.shots = 1;
  options.iterations = 1;
  const Solution start = solve_southwell(bench, mesh, matrix, options);
  REQUIRE_FALSE(start.converged);
  // One shot of E_0 = 4 brings 4 / 8 everywhere; the sides reflect rho of it. By hand, for rho_mean = 7 rho / 8.
  for (const std::size_t c : {0U, 1U}) {
    const double rho = c == 0 ? 0.5 : 0.75, mean = rho * 7.0 / 8.0, unshot = 0.5 * mean;
    CHECK(std::abs(start.irradiance[2][c] - 0.5) < 1e-7);
    CHECK(std::abs(start.ambient[c] - unshot / (1.0 - mean)) < 1e-6);
    // In a sphere, where all light comes to all places alike, the guess is the truth.
    CHECK(std::abs(start.irradiance[2][c] + start.ambient[c] - 0.5 / (1.0 - mean)) < 1e-6);
  }
  CHECK(std::abs(start.unshot_w - 8.0 * 0.5 * (7.0 / 8.0) * (0.5 + 0.75 + 0.5)) < 1e-5);
  options.iterations = 1000;
  const Solution end = solve_southwell(bench, mesh, matrix, options);
  REQUIRE(end.converged);
  CHECK(end.ambient == std::array<double, 3>{0.0, 0.0, 0.0});
}

TEST_CASE("rows on demand give what stored rows give, and a bound") {
  RadiosityBench bench;
  FlatScene flat = test::flat_without_materials();
  test::add_room(flat, Vec3(1.0F), test::add_material(flat, Vec3(0.7F, 0.5F, 0.2F), Vec3(0.0F)));
  test::add_quad(flat, Vec3(0.4F, 0.95F, 0.4F), Vec3(0.2F, 0, 0), Vec3(0, 0, 0.2F),
                 test::add_material(flat, Vec3(0.0F), Vec3(10.0F)));
  const PatchMesh mesh = make_patch_mesh(flat, {0.0, 100, 0.0});
  HemicubeOptions cubes;
  cubes.resolution = 32;
  Hemicubes hemicubes(bench.context, bench.parallel, bench.builder, mesh, cubes);
  std::vector<std::uint32_t> all(mesh.side_count());
  std::iota(all.begin(), all.end(), 0U);
  FactorMatrix matrix;
  hemicubes.add_rows(all, matrix);
  std::size_t asked = 0;
  const RowsOnDemand rows = [&](std::span<const std::uint32_t> sides) {
    FactorMatrix some;
    hemicubes.add_rows(sides, some);
    asked += sides.size();
    return some;
  };
  SolveOptions options;
  options.shots = 8;
  const Solution stored = solve_southwell(bench, mesh, matrix, options);
  const Solution fresh = solve_radiosity_on_demand(bench.context, mesh, rows, options);
  REQUIRE(stored.converged);
  REQUIRE(fresh.converged);
  CHECK(fresh.on_demand);
  CHECK(fresh.kind == SolverKind::southwell);
  CHECK(fresh.radiosity == stored.radiosity);
  CHECK(fresh.bounds == stored.bounds);
  CHECK(asked > 0);
  CHECK(fresh.history.size() == stored.history.size());
}

}  // namespace hemiray
