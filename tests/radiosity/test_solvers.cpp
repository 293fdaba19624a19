// Every solver on systems with known solutions: by hand, by elimination, and each against the others.
#include <catch2/catch.hpp>

#include <cmath>
#include <limits>

#include "host/base/error.hpp"
#include "host/radiosity/solve_checks.hpp"
#include "tests/radiosity/radiosity_bench.hpp"
#include "tests/radiosity/synthetic_system.hpp"

namespace hemiray {
namespace {

using test::RadiosityBench;
using test::SyntheticPatch;

constexpr SolverKind kSolvers[] = {SolverKind::jacobi, SolverKind::gauss_seidel, SolverKind::southwell, SolverKind::cg,
                                   SolverKind::gmres};

SolveOptions options_for(SolverKind kind, double tolerance) {
  SolveOptions options;
  options.kind = kind;
  options.tolerance = tolerance;
  options.iterations = 100000;
  options.shots = 4;
  return options;
}

// What elimination in double may be off by in these tests.
constexpr double kEliminated = 1e-11;

double relative_difference(const Solution& a, const Solution& b) {
  double worst = 0.0;
  for (std::size_t s = 0; s < a.radiosity.size(); s++) {
    for (std::size_t c = 0; c < 3; c++) worst = std::max(worst, std::abs(a.radiosity[s][c] - b.radiosity[s][c]));
  }
  return worst / b.largest;
}

// Few sides of unlike areas and colours that see themselves.
std::vector<SyntheticPatch> unlike_patches() {
  return {{1.0F, {0.8F, 0.3F, 0.0F}, {1.0F, 0.5F, 0.25F}},
          {4.0F, {0.5F, 0.9F, 0.1F}, {0.0F, 0.0F, 2.0F}},
          {0.25F, {0.9F, 0.0F, 0.4F}, {0.0F, 0.0F, 0.0F}},
          {16.0F, {0.7F, 0.6F, 0.5F}, {0.0F, 0.125F, 0.0F}}};
}

}  // namespace

TEST_CASE("tiny: every solver solves a system whose sides see themselves") {
  RadiosityBench bench;
  const PatchMesh mesh = test::synthetic_mesh(unlike_patches());
  const std::vector<FactorRow> rows = test::sphere_rows(mesh);
  const FactorMatrix matrix = test::matrix_of(bench.context, rows, 3);
  for (const bool single : {false, true}) {
    for (const SolverKind kind : kSolvers) {
      // Float-float residuals of radiosities in float: a few roundings of these, times 1 / (1 - rho) = 10.
      SolveOptions options = options_for(kind, single ? 2e-5 : 1e-9);
      options.single_precision = single;
      const Solution solution = solve_radiosity(bench.context, mesh, matrix, options);
      CAPTURE(to_string(kind), single, solution.history.size());
      CHECK(solution.kind == kind);
      REQUIRE(solution.converged);
      for (std::size_t c = 0; c < 3; c++) {
        const std::vector<double> exact = test::eliminate(mesh, rows, c);
        for (std::uint32_t s = 0; s < mesh.side_count(); s++) {
          CHECK(std::abs(solution.radiosity[s][c] - exact[s]) <= solution.bounds[s] + 1e-12);
          CHECK(solution.bounds[s] <= options.tolerance * solution.largest);
        }
      }
    }
  }
}

TEST_CASE("tiny: translucent sides pass light on, by every solver but conjugate gradients") {
  RadiosityBench bench;
  PatchMesh mesh = test::synthetic_mesh({{1.0F, {0.5F, 0.5F, 0.5F}, {1.0F, 1.0F, 1.0F}},
                                         {2.0F, {0.25F, 0.25F, 0.25F}, {0.0F, 0.0F, 0.0F}},
                                         {1.0F, {0.75F, 0.75F, 0.5F}, {0.0F, 0.0F, 0.0F}}});
  mesh.transmittance[3] = {0.5F, 0.25F, 0.0F, 0.0F};
  mesh.transmittance[2] = {0.25F, 0.0F, 0.0F, 0.0F};
  // Patch 0 and the front of 1 see each other, and the back of 1 and patch 2; a third of 2's light returns to it.
  std::vector<FactorRow> rows(mesh.side_count());
  rows[0] = {{2, 1.0F}};
  rows[2] = {{0, 0.5F}};
  rows[3] = {{4, 0.25F}};
  rows[4] = {{3, 0.5F}, {4, 0.375F}};
  const FactorMatrix matrix = test::matrix_of(bench.context, rows, 2);
  for (const SolverKind kind : kSolvers) {
    CAPTURE(to_string(kind));
    if (kind == SolverKind::cg) {
      CHECK_THROWS_AS(solve_radiosity(bench.context, mesh, matrix, options_for(kind, 1e-9)), InputError);
      continue;
    }
    const Solution solution = solve_radiosity(bench.context, mesh, matrix, options_for(kind, 1e-9));
    REQUIRE(solution.converged);
    for (std::size_t c = 0; c < 3; c++) {
      const std::vector<double> exact = test::eliminate(mesh, rows, c);
      CHECK((exact[4] > 0.0) == (c < 2));  // all of its light has come through
      for (std::uint32_t s = 0; s < mesh.side_count(); s++) {
        CHECK(std::abs(solution.radiosity[s][c] - exact[s]) <= solution.bounds[s] + 1e-12);
      }
    }
  }
  CHECK(solve_radiosity(bench.context, mesh, matrix, {}).kind == SolverKind::gmres);
}

TEST_CASE("two patches and endless plates, by hand") {
  RadiosityBench bench;
  // B1 = (E1 + rho1 F12 E2) / (1 - rho1 rho2 F12 F21); plates have F12 = F21 = 1.
  struct Pair {
    float area1, area2, f12;
  };
  for (const Pair pair : {Pair{1.0F, 1.0F, 1.0F}, Pair{1.0F, 4.0F, 0.5F}}) {
    const float f21 = pair.area1 * pair.f12 / pair.area2;
    const PatchMesh mesh = test::synthetic_mesh(
        {{pair.area1, {0.5F, 0.99F, 0.0F}, {1.0F, 1.0F, 1.0F}}, {pair.area2, {0.75F, 0.5F, 0.5F}, {0.0F, 2.0F, 3.0F}}});
    std::vector<FactorRow> rows(4);
    rows[0] = {{2, pair.f12}};
    rows[2] = {{0, f21}};
    const FactorMatrix matrix = test::matrix_of(bench.context, rows);
    for (const SolverKind kind : kSolvers) {
      const Solution solution = solve_radiosity(bench.context, mesh, matrix, options_for(kind, 1e-9));
      CAPTURE(to_string(kind), pair.f12);
      REQUIRE(solution.converged);
      const double f = static_cast<double>(pair.f12), g = static_cast<double>(f21);
      const double rho1[] = {0.5, static_cast<double>(0.99F), 0.0}, rho2[] = {0.75, 0.5, 0.5}, e2[] = {0.0, 2.0, 3.0};
      for (std::size_t c = 0; c < 3; c++) {
        const double bounce = 1.0 - rho1[c] * rho2[c] * f * g;
        CHECK(std::abs(solution.radiosity[0][c] - (1.0 + rho1[c] * f * e2[c]) / bounce) < 1e-8);
        CHECK(std::abs(solution.radiosity[2][c] - (e2[c] + rho2[c] * g) / bounce) < 1e-8);
      }
    }
  }
}

TEST_CASE("in a closed room all that is emitted is absorbed, and a sphere's solution is known") {
  RadiosityBench bench;
  const PatchMesh mesh = test::synthetic_mesh(unlike_patches());
  const FactorMatrix matrix = test::matrix_of(bench.context, test::sphere_rows(mesh));
  double area = 0.0, rho_mean = 0.0, e_mean = 0.0;
  for (std::uint32_t i = 0; i < mesh.patch_count(); i++) {
    const auto a = static_cast<double>(mesh.normals[i].w);
    area += a;
    rho_mean += a * static_cast<double>(mesh.reflectance[2 * i].x);
    e_mean += a * static_cast<double>(mesh.emission[2 * i].x);
  }
  rho_mean /= area;
  e_mean /= area;
  for (const SolverKind kind : kSolvers) {
    const Solution solution = solve_radiosity(bench.context, mesh, matrix, options_for(kind, 1e-8));
    CAPTURE(to_string(kind));
    REQUIRE(solution.converged);
    double absorbed = 0.0;
    for (std::uint32_t i = 0; i < mesh.patch_count(); i++) {
      const double rho = static_cast<double>(mesh.reflectance[2 * i].x),
                   e = static_cast<double>(mesh.emission[2 * i].x);
      absorbed += static_cast<double>(mesh.normals[i].w) * (1.0 - rho) * solution.irradiance[2 * i][0];
      CHECK(std::abs(solution.radiosity[2 * i][0] - (e + rho * e_mean / (1.0 - rho_mean))) < 1e-6);
    }
    CHECK(std::abs(absorbed - area * e_mean) < 1e-6 * area * e_mean);
  }
}

TEST_CASE("tiny: rows are summed whole, and a factor that cannot be is found wherever it stands") {
  RadiosityBench bench;
  constexpr std::uint32_t kLongest = 9;
  const auto mesh_of = [](float rho) {
    return test::synthetic_mesh(std::vector<SyntheticPatch>(kLongest, {1.0F, {rho, rho, rho}, {1.0F, 1.0F, 1.0F}}));
  };
  const PatchMesh bright = mesh_of(0.75F), dark = mesh_of(0.5F);
  const auto refused = [&](const PatchMesh& mesh, const FactorRow& row) {
    std::vector<FactorRow> rows(mesh.side_count());
    rows[0] = row;
    try {
      check_rows(bench.context, mesh, test::matrix_of(bench.context, rows));
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  for (std::uint32_t length = 1; length <= kLongest; length++) {
    FactorRow row;
    for (std::uint32_t k = 0; k < length; k++) row.emplace_back(2 * k, 1.5F / static_cast<float>(length));
    CAPTURE(length);
    CHECK(refused(dark, row).empty());
    CHECK_THAT(refused(bright, row), Catch::Contains("sum to 1.5"));
    for (std::uint32_t k = 0; k < length; k++) {
      FactorRow wrong = row;
      wrong[k].second = -0.25F;
      CHECK_THAT(refused(dark, wrong), Catch::Contains("is -0.25;"));
      wrong[k].second = std::numeric_limits<float>::quiet_NaN();
      CHECK_THAT(refused(dark, wrong), Catch::Contains("nan;"));
    }
  }
}

TEST_CASE("the bound is asked for where it will do, and no residual is computed twice") {
  RadiosityBench bench;
  // Every row sums to 1: Jacobi's residuals fall by rho an iteration, so that where it ends is known beforehand.
  const PatchMesh mesh = test::synthetic_mesh(
      {{1.0F, {0.75F, 0.75F, 0.75F}, {1.0F, 1.0F, 1.0F}}, {1.0F, {0.75F, 0.75F, 0.75F}, {1.0F, 1.0F, 1.0F}}});
  const FactorMatrix matrix = test::matrix_of(bench.context, test::sphere_rows(mesh));
  const auto gathers = [&bench] {
    std::uint64_t launches = 0;
    for (const StageTime& stage : bench.context.profiler().stages()) {
      if (stage.name == "radiosity_gather") launches = stage.launches;
    }
    return launches;
  };
  SolveOptions options = options_for(SolverKind::jacobi, 1e-6);
  std::uint64_t before = gathers();
  const Solution jacobi = solve_radiosity(bench.context, mesh, matrix, options);
  const std::uint32_t last = jacobi.history.back().iteration;
  REQUIRE(jacobi.converged);
  CHECK(jacobi.history.size() < last / 3);
  CHECK(gathers() - before == last + 1);
  options.iterations = last - 1;
  CHECK_FALSE(solve_radiosity(bench.context, mesh, matrix, options).converged);

  const PatchMesh unlike = test::synthetic_mesh(unlike_patches());
  const FactorMatrix of_unlike = test::matrix_of(bench.context, test::sphere_rows(unlike));
  for (const SolverKind kind : {SolverKind::cg, SolverKind::gmres}) {
    options = options_for(kind, 1e-9);
    options.restart = 2;
    before = gathers();
    const Solution solution = solve_radiosity(bench.context, unlike, of_unlike, options);
    const std::uint32_t iterations = solution.history.back().iteration;
    std::uint64_t fresh = 0;  // of the restarts, those whose residual the bound was asked for
    for (const SolveStep& step : solution.history) fresh += step.iteration % 2 == 0 && step.iteration < iterations;
    CAPTURE(to_string(kind), iterations, solution.history.size());
    CHECK(fresh > 0);
    CHECK(gathers() - before == iterations + (iterations + 1) / 2 + solution.history.size() - fresh);
  }
}

TEST_CASE("a furnace of reflectance 0.999 is solved in few iterations by Krylov methods, and by all in the end") {
  RadiosityBench bench;
  FlatScene flat = test::flat_without_materials();
  test::add_room(flat, Vec3(1.0F, 2.0F, 0.5F), test::add_material(flat, Vec3(0.999F, 0.9F, 0.0F), Vec3(1.0F)));
  const PatchMesh mesh = make_patch_mesh(flat, {0.0, 100, 0.0});
  const FactorMatrix matrix = test::factors_of_fronts(bench, mesh, {});
  const double exact = 1.0 / (1.0 - static_cast<double>(0.999F));
  for (const SolverKind kind : {SolverKind::gmres, SolverKind::gauss_seidel, SolverKind::jacobi}) {
    for (const bool single : {false, true}) {
      SolveOptions options = options_for(kind, 1e-3);
      options.single_precision = single;
      const Solution solution = solve_radiosity(bench.context, mesh, matrix, options);
      CAPTURE(to_string(kind), single, solution.history.back().iteration, solution.history.back().bound);
      REQUIRE(solution.converged);
      if (kind == SolverKind::gmres) CHECK(solution.history.back().iteration <= 10);
      // Row sums are off by float roundings, which 1 / (1 - rho) makes 1000 times larger.
      for (std::uint32_t i = 0; i < mesh.patch_count(); i++) {
        CHECK(std::abs(solution.radiosity[2 * i][0] - exact) < 2e-3 * exact);
      }
    }
  }
}

TEST_CASE("all solvers agree on a room, at any reflectance") {
  RadiosityBench bench;
  for (const float rho : {0.5F, 0.9F, 0.999F}) {
    FlatScene flat = test::flat_without_materials();
    test::add_room(flat, Vec3(1.0F), test::add_material(flat, Vec3(rho, 0.5F * rho, 0.0F), Vec3(0.0F)));
    test::add_quad(flat, Vec3(0.4F, 0.95F, 0.4F), Vec3(0.2F, 0, 0), Vec3(0, 0, 0.2F),
                   test::add_material(flat, Vec3(0.0F), Vec3(10.0F)));
    const PatchMesh mesh = make_patch_mesh(flat, {0.0, 150, 0.0});
    const FactorMatrix raw = test::factors_of_fronts(bench, mesh, {});
    const FactorMatrix matrix = test::matrix_of(bench.context, test::symmetric_rows(mesh, read_rows(raw)), 40);
    CHECK(find_asymmetry(bench.context, mesh, raw, 1.0) > kSymmetric);
    CHECK(find_asymmetry(bench.context, mesh, matrix, 1.0) < 1e-6);
    CHECK_THROWS_AS(solve_radiosity(bench.context, mesh, raw, options_for(SolverKind::cg, 1e-6)), InputError);
    CHECK(solve_radiosity(bench.context, mesh, raw, {}).kind == SolverKind::gmres);
    CHECK(solve_radiosity(bench.context, mesh, matrix, {}).kind == SolverKind::cg);
    const Solution reference = solve_radiosity(bench.context, mesh, matrix, options_for(SolverKind::gmres, 1e-9));
    REQUIRE(reference.converged);
    const double tolerance = rho > 0.9F ? 1e-3 : 1e-5;
    for (const SolverKind kind : kSolvers) {
      SolveOptions options = options_for(kind, 0.5 * tolerance);
      options.shots = 16;
      const Solution solution = solve_radiosity(bench.context, mesh, matrix, options);
      CAPTURE(to_string(kind), rho, solution.history.back().iteration, solution.history.back().bound);
      REQUIRE(solution.converged);
      CHECK(relative_difference(solution, reference) < tolerance);
    }
  }
}

TEST_CASE("the certificate holds wherever a solver is stopped, in double and without") {
  RadiosityBench bench;
  FlatScene flat = test::flat_without_materials();
  test::add_room(flat, Vec3(1.0F), test::add_material(flat, Vec3(0.95F, 0.7F, 0.2F), Vec3(0.0F)));
  test::add_quad(flat, Vec3(0.4F, 0.95F, 0.4F), Vec3(0.2F, 0, 0), Vec3(0, 0, 0.2F),
                 test::add_material(flat, Vec3(0.0F), Vec3(10.0F)));
  const PatchMesh mesh = make_patch_mesh(flat, {0.0, 100, 0.0});
  const std::vector<FactorRow> rows = test::symmetric_rows(mesh, read_rows(test::factors_of_fronts(bench, mesh, {})));
  const FactorMatrix matrix = test::matrix_of(bench.context, rows);
  // Factors in single precision are symmetric to its roundings only, so southwell's system is another.
  const auto transposed = test::by_reciprocity(mesh, rows);
  std::array<std::array<std::vector<double>, 3>, 2> exact;
  for (std::size_t c = 0; c < 3; c++) exact[0][c] = test::eliminate(mesh, rows, c);
  for (std::size_t c = 0; c < 3; c++) exact[1][c] = test::eliminate(mesh, transposed, c);
  for (const bool single : {false, true}) {
    for (const SolverKind kind : kSolvers) {
      for (const std::uint32_t iterations : {0U, 1U, 3U, 20U, 100000U}) {
        SolveOptions options = options_for(kind, single ? 1e-4 : 1e-8);
        options.single_precision = single;
        options.iterations = iterations;
        options.shots = 16;
        const Solution solution = solve_radiosity(bench.context, mesh, matrix, options);
        const double bound = solution.history.back().bound;
        CAPTURE(to_string(kind), single, iterations, bound);
        if (iterations == 100000) CHECK(solution.converged);
        CHECK(solution.history.back().iteration <= iterations);
        double worst = 0.0;
        for (std::uint32_t s = 0; s < mesh.side_count(); s++) {
          for (std::size_t c = 0; c < 3; c++) {
            const double error = std::abs(solution.radiosity[s][c] - exact[kind == SolverKind::southwell][c][s]);
            CHECK(error <= solution.bounds[s] + kEliminated);
            worst = std::max(worst, error);
          }
        }
        // Shooting starts without any w.
        if (kind != SolverKind::southwell) CHECK(std::isfinite(bound));
        if (iterations == 100000 && !single) CHECK(bound < 1000.0 * worst + kEliminated);
      }
    }
  }
}

TEST_CASE("systems without a solution are refused, and name the patch") {
  RadiosityBench bench;
  const auto refused = [&](const PatchMesh& mesh, const FactorMatrix& matrix, const char* says) {
    for (const SolverKind kind : kSolvers) {
      try {
        (void)solve_radiosity(bench.context, mesh, matrix, options_for(kind, 1e-4));
        FAIL("not refused");
      } catch (const InputError& error) {
        CAPTURE(error.what(), says);
        CHECK(std::string(error.what()).find(says) != std::string::npos);
      }
    }
  };
  std::vector<SyntheticPatch> patches = unlike_patches();
  const PatchMesh good = test::synthetic_mesh(patches);
  std::vector<FactorRow> rows = test::sphere_rows(good);
  patches[2].rho[1] = 1.0F;
  refused(test::synthetic_mesh(patches), test::matrix_of(bench.context, rows), "patch 2 (front)");
  PatchMesh thin = good;
  thin.transmittance[3] = {0.0F, 0.25F, 0.0F, 0.0F};  // 0.9 comes back from the front, 0.25 goes through it
  refused(thin, test::matrix_of(bench.context, rows), "patch 1 (front)");
  for (auto& [column, value] : rows[6]) value *= 1.5F;
  refused(good, test::matrix_of(bench.context, rows), "patch 3 (front)");
  rows[6][0].second = -0.1F;
  refused(good, test::matrix_of(bench.context, rows), "patch 3 (front)");
}

}  // namespace hemiray
