// Solutions that go on from where they were stopped: the same bits, from every solver and at every iteration.
#include <catch2/catch.hpp>

#include "host/base/error.hpp"
#include "host/radiosity/radiosity.hpp"
#include "host/radiosity/solution_key.hpp"
#include "tests/radiosity/radiosity_bench.hpp"
#include "tests/radiosity/synthetic_system.hpp"
#include "tests/support/temp_folder.hpp"

namespace hemiray {
namespace {

using test::RadiosityBench;

// A system of unlike sides that takes tens of iterations, translucent or not.
PatchMesh mesh_of(bool translucent) {
  std::vector<test::SyntheticPatch> patches;
  for (int i = 0; i < 40; i++) {
    const float f = static_cast<float>(i) / 40.0F;
    patches.push_back({1.0F + f, {0.95F - 0.3F * f, 0.6F + 0.3F * f, 0.7F}, {i % 7 == 0 ? 1.0F : 0.0F, f, 0.5F}});
  }
  // Dark ones, which southwell shoots for the bound alone.
  for (std::size_t i = 3; i < patches.size(); i += 5) {
    patches[i].rho = {1e-4F, 1e-4F, 1e-4F};
    patches[i].e = {0.0F, 0.0F, 0.0F};
  }
  PatchMesh mesh = test::synthetic_mesh(patches);
  if (!translucent) return mesh;
  // Light that arrives at the second front leaves its back, which the third one sees; and the other way round.
  mesh.transmittance[3] = {0.5F, 0.25F, 0.0F, 0.0F};
  mesh.transmittance[2] = {0.25F, 0.5F, 0.125F, 0.0F};
  mesh.reflectance[2] = {0.4F, 0.3F, 0.2F, 0.4F};
  return mesh;
}

// Symmetric, but otherwise without order: no solver is done at once.
std::vector<FactorRow> rows_of(const PatchMesh& mesh, bool translucent) {
  std::vector<FactorRow> rows(mesh.side_count());
  for (std::uint32_t i = 0; i < mesh.patch_count(); i++) {
    for (std::uint32_t j = 0; j < mesh.patch_count(); j++) {
      if (i != j) rows[2 * i].emplace_back(2 * j, static_cast<float>((7 * i + 13 * j) % 11));
    }
  }
  rows = test::symmetric_rows(mesh, rows);
  if (translucent) rows[3] = {{4, 0.5F}};
  return rows;
}

bool same_bits(const Solution& a, const Solution& b) {
  if (a.history.size() != b.history.size()) return false;
  for (std::size_t i = 0; i < a.history.size(); i++) {
    if (a.history[i].iteration != b.history[i].iteration || a.history[i].bound != b.history[i].bound ||
        a.history[i].residual != b.history[i].residual) {
      return false;
    }
  }
  return a.radiosity == b.radiosity && a.irradiance == b.irradiance && a.bounds == b.bounds &&
         a.converged == b.converged && a.unshot_w == b.unshot_w;
}

// Two triangles a wall, lit from the ceiling.
FlatScene small_room() {
  FlatScene flat = test::flat_without_materials();
  const std::uint32_t wall = test::add_material(flat, Vec3(0.7F, 0.5F, 0.3F), Vec3(0.0F)),
                      lamp = test::add_material(flat, Vec3(0.1F), Vec3(3.0F, 2.0F, 1.0F));
  test::add_room(flat, Vec3(1.0F, 1.0F, 1.5F), wall);
  test::add_quad(flat, Vec3(0.3F, 0.9F, 0.3F), Vec3(0.3F, 0, 0), Vec3(0, 0, 0.3F), lamp);
  return flat;
}

RadiosityOptions small_options(FormFactors method) {
  RadiosityOptions options;
  options.mesh.patches = 100;
  options.factors.method = method;
  options.factors.hemicube.resolution = 16;
  options.factors.hemicube.batch_bytes = 1 << 16;  // 21 rows a batch
  options.residual_samples = 0;
  options.keep.every_s = 0.0;
  return options;
}

}  // namespace

TEST_CASE("every solver goes on with the same bits from every iteration") {
  RadiosityBench bench;
  for (const bool translucent : {false, true}) {
    const PatchMesh mesh = mesh_of(translucent);
    const std::vector<FactorRow> rows = rows_of(mesh, translucent);
    const FactorMatrix matrix = test::matrix_of(bench.context, rows, 16);
    for (const SolverKind kind :
         {SolverKind::jacobi, SolverKind::gauss_seidel, SolverKind::southwell, SolverKind::cg, SolverKind::gmres}) {
      if (kind == SolverKind::cg && translucent) continue;
      for (const bool single : {false, true}) {
        SolveOptions options;
        options.kind = kind;
        options.tolerance = single ? 1e-4 : 1e-10;
        // So loose that it shoots for the bound at the end, not for the colours.
        if (kind == SolverKind::southwell) options.tolerance = 0.05;
        options.single_precision = single;
        options.shots = 3;
        options.group = 2;  // parts sides of one patch
        options.restart = 4;
        const Solution whole = solve_radiosity(bench.context, mesh, matrix, options);
        const std::uint32_t last = whole.history.back().iteration;
        CAPTURE(to_string(kind), single, translucent, last);
        REQUIRE(whole.converged);
        REQUIRE(last >= 3);
        const std::uint32_t step = 1 + last / 8;
        for (std::uint32_t stop = 1; stop <= last; stop += step) {
          std::vector<std::uint8_t> state;
          SolveOptions stopped = options, resumed = options;
          stopped.on_iteration = [stop](std::uint32_t iteration, double) { return iteration < stop; };
          stopped.offer_state = [&](bool ends, const auto& take) {
            if (ends) state = take();
          };
          const Solution part = solve_radiosity(bench.context, mesh, matrix, stopped);
          REQUIRE(!state.empty());
          resumed.continue_from = state;
          CAPTURE(stop, part.history.back().iteration);
          CHECK(same_bits(solve_radiosity(bench.context, mesh, matrix, resumed), whole));
        }
      }
    }
  }
}

TEST_CASE("a solver's state of another system is refused") {
  RadiosityBench bench;
  const PatchMesh mesh = mesh_of(false);
  const FactorMatrix matrix = test::matrix_of(bench.context, rows_of(mesh, false));
  std::vector<std::uint8_t> state;
  SolveOptions options;
  options.kind = SolverKind::gmres;
  options.offer_state = [&](bool, const auto& take) { state = take(); };
  static_cast<void>(solve_radiosity(bench.context, mesh, matrix, options));
  options.offer_state = {};
  for (const std::size_t size : {std::size_t{1}, state.size() / 2, state.size() - 1, state.size() + 1}) {
    options.continue_from = state;
    options.continue_from.resize(size);
    CHECK_THROWS_AS(solve_radiosity(bench.context, mesh, matrix, options), InputError);
  }
}

TEST_CASE("a solution that is stopped in factors or iterations goes on from its file with the same bits") {
  RadiosityBench bench;
  const FlatScene flat = small_room();
  using enum FactorPrecision;
  for (const auto& [method, precision] :
       {std::pair(FormFactors::hemicube, single), {FormFactors::hybrid, single}, {FormFactors::hemicube, half}}) {
    RadiosityOptions options = small_options(method);
    options.factors.precision = precision;
    const Radiosity whole = compute_radiosity(bench.context, flat, options);
    REQUIRE(whole.solution.converged);
    for (const int stop : {1, 3, 6, 9, 12}) {
      const test::TempFolder folder;
      RadiosityOptions stopped = options, resumed = options;
      stopped.keep.file = resumed.keep.file = (folder / "a.solution").string();
      resumed.keep.resume = true;
      int calls = 0;
      stopped.on_progress = [&](const std::string&, double) { return ++calls < stop; };
      stopped.solve.on_iteration = [&](std::uint32_t, double) { return ++calls < stop; };
      const Radiosity part = compute_radiosity(bench.context, flat, stopped);
      const Radiosity rest = compute_radiosity(bench.context, flat, resumed);
      CAPTURE(static_cast<int>(method), to_string(precision), stop, part.statistics.rows, rest.statistics.kept_rows);
      CHECK(same_bits(rest.solution, whole.solution));
      CHECK(rest.irradiance == whole.irradiance);
      CHECK(rest.statistics.rows == whole.statistics.rows);
      if (method == FormFactors::hemicube) CHECK(rest.statistics.kept_rows == part.statistics.rows);
      // The file is that of the finished solution now.
      const Radiosity again = compute_radiosity(bench.context, flat, resumed);
      CHECK(same_bits(again.solution, whole.solution));
      CHECK(again.statistics.kept_rows == whole.statistics.rows);
      CHECK(again.statistics.rays == 0);
      CHECK(again.statistics.rounding.has_value() == (precision == half));
      if (again.statistics.rounding) CHECK(again.statistics.rounding->mean == whole.statistics.rounding->mean);
    }
  }
}

TEST_CASE("southwell without a matrix goes on from its file, too") {
  RadiosityBench bench;
  const FlatScene flat = small_room();
  RadiosityOptions options = small_options(FormFactors::hemicube);
  options.factor_bytes = 20000;
  const Radiosity whole = compute_radiosity(bench.context, flat, options);
  REQUIRE(whole.solution.on_demand);
  const test::TempFolder folder;
  options.keep.file = (folder / "a.solution").string();
  RadiosityOptions stopped = options;
  stopped.solve.on_iteration = [](std::uint32_t iteration, double) { return iteration < 5; };
  static_cast<void>(compute_radiosity(bench.context, flat, stopped));
  options.keep.resume = true;
  const Radiosity rest = compute_radiosity(bench.context, flat, options);
  CHECK(rest.solution.on_demand);
  CHECK(same_bits(rest.solution, whole.solution));
}

TEST_CASE("solutions with other input are told apart, in words") {
  RadiosityBench bench;
  const FlatScene flat = small_room();
  const RadiosityOptions options = small_options(FormFactors::hybrid);
  const std::string key = solution_key(bench.context, flat, options);
  CHECK(difference_of_keys(key, solution_key(bench.context, flat, options)).empty());
  RadiosityOptions other = options;
  other.mesh.patches = 200;
  other.solve.tolerance = 1e-3;
  other.factors.precision = FactorPrecision::half;
  CHECK_THAT(difference_of_keys(key, solution_key(bench.context, flat, other)),
             Catch::Contains("--patches (100 there, 200 now)") &&
                 Catch::Contains("--tolerance (0.0001 there, 0.001 now)") && Catch::Contains("--factor-precision"));
  FlatScene brighter = flat;
  brighter.materials[1].emission.x *= 2.0F;
  CHECK(difference_of_keys(key, solution_key(bench.context, brighter, options)) == "scene");
  // What only says when to end, or is done with the solution, makes no other bits.
  other = options;
  other.solve.seconds = 1.0;
  other.residual_samples = 10;
  CHECK(difference_of_keys(key, solution_key(bench.context, flat, other)).empty());
  CHECK_THROWS_AS(difference_of_keys("[", key), InputError);
}

}  // namespace hemiray
