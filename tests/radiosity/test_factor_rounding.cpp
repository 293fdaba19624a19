// Form factors in half precision: rounded as IEEE 754 says, read alike by every solver, and no farther off than they
// say.
#include <catch2/catch.hpp>

#include <cmath>

#include "host/radiosity/factor_memory.hpp"
#include "host/radiosity/factor_rounding.hpp"
#include "host/radiosity/radiosity.hpp"
#include "tests/radiosity/radiosity_bench.hpp"
#include "tests/radiosity/synthetic_system.hpp"

namespace hemiray {
namespace {

using test::RadiosityBench;

// To 11 bits, or to the multiple of 2^-24 below them, of numbers scaled so that `most` lies in [2^14, 2^15).
double to_half(double value, double most) {
  const int scale = std::ilogb(most) - 14, exponent = std::max(std::ilogb(value) - 10, scale - 24);
  return std::ldexp(std::nearbyint(std::ldexp(value, -exponent)), exponent);
}

PatchMesh mesh_of(std::uint32_t patches) {
  std::vector<test::SyntheticPatch> all;
  for (std::uint32_t i = 0; i < patches; i++) {
    const float f = static_cast<float>(i) / static_cast<float>(patches);
    all.push_back({1.0F + 3.0F * f, {0.9F - 0.3F * f, 0.2F + 0.3F * f, 0.7F}, {f, i % 3 == 0 ? 1.0F : 0.0F, 0.5F}});
  }
  return test::synthetic_mesh(all);
}

// Exchange areas of a sphere's patches, symmetric to the bit.
FactorMatrix sphere_exchange(Context& context, const PatchMesh& mesh) {
  std::vector<FactorRow> rows = test::sphere_rows(mesh);
  for (std::uint32_t i = 0; i < rows.size(); i++) {
    for (auto& [j, value] : rows[i]) value = mesh.normals[i / 2].w * mesh.normals[j / 2].w / 128.0F;
  }
  return test::matrix_of(context, rows, 3);
}

FlatScene room() {
  FlatScene flat = test::flat_without_materials();
  test::add_room(flat, Vec3(1.0F, 1.0F, 1.5F), test::add_material(flat, Vec3(0.8F, 0.5F, 0.3F), Vec3(0.0F)));
  test::add_quad(flat, Vec3(0.3F, 0.9F, 0.3F), Vec3(0.3F, 0, 0), Vec3(0, 0, 0.3F),
                 test::add_material(flat, Vec3(0.1F), Vec3(3.0F, 2.0F, 1.0F)));
  return flat;
}

}  // namespace

TEST_CASE("tiny: factors are rounded to the nearest half, ties to even, and rows of small ones are scaled") {
  RadiosityBench bench;
  const PatchMesh mesh = mesh_of(8);
  std::vector<FactorRow> rows(mesh.side_count());
  const float ulp = 0x1p-10F;
  const std::vector<float> values = {1.0F + 0.5F * ulp, 1.0F + 1.5F * ulp, 1.0F + 0.501F * ulp, 0.3F,     0.1234567F,
                                     3.1e-9F,           7.77e-12F,         0x1p-40F * 0.99F,    0x1p-39F, 1.9F};
  for (std::uint32_t row = 0; row < 6; row++) {
    for (std::uint32_t j = 0; j < values.size(); j++) {
      rows[row].emplace_back(j, std::ldexp(values[j], row == 0 ? 0 : -5 * static_cast<int>(row) - 20));
    }
  }
  FactorMatrix matrix = test::matrix_of(bench.context, rows, 4);
  REQUIRE(matrix.blocks.size() == 2);
  FactorRounder rounder(bench.context, mesh);
  for (FactorBlock& block : matrix.blocks) rounder.round(block, false);
  CHECK(matrix.precision() == FactorPrecision::half);
  const std::vector<FactorRow> rounded = read_rows(matrix);
  const std::vector<double> changes = row_changes(matrix);
  double largest = 0.0, mean = 0.0, row_sum = 0.0;
  for (std::uint32_t row = 0; row < 6; row++) {
    const double most = std::ldexp(1.9, row == 0 ? 0 : -5 * static_cast<int>(row) - 20);
    double change = 0.0, sum = 0.0;
    for (std::uint32_t j = 0; j < values.size(); j++) {
      const auto before = static_cast<double>(rows[row][j].second), after = static_cast<double>(rounded[row][j].second);
      CAPTURE(row, j, before);
      CHECK(after == to_half(before, most));
      change += std::abs(after - before);
      sum += after - before;
      largest = std::max(largest, std::abs(after - before) / before);
      mean += std::abs(after - before) / before / static_cast<double>(6 * values.size());
    }
    CHECK(changes[row] >= change);
    CHECK(changes[row] == Approx(change).epsilon(1e-5));
    row_sum = std::max(row_sum, std::abs(sum));
  }
  CHECK(rounded[0][0].second == 1.0F);
  CHECK(rounded[0][1].second == 1.0F + 2.0F * ulp);
  CHECK(rounded[0][7].second == 0.0F);
  const FactorRounding facts = rounding_of(matrix);
  CHECK(facts.largest == Approx(largest).epsilon(1e-5));
  CHECK(facts.mean == Approx(mean).epsilon(1e-5));
  CHECK(facts.row_sum_change == Approx(row_sum).epsilon(1e-5));
  CHECK(facts.bytes_saved == 60 * 2 - 6 * 4);
}

TEST_CASE("tiny: every solver solves with rounded factors, which stay symmetric") {
  RadiosityBench bench;
  const PatchMesh mesh = mesh_of(5);
  FactorMatrix matrix = sphere_exchange(bench.context, mesh);
  FactorRounder rounder(bench.context, mesh);
  for (FactorBlock& block : matrix.blocks) rounder.round(block, true);
  const std::vector<FactorRow> rows = read_rows(matrix);
  for (const bool single : {false, true}) {
    for (const SolverKind kind :
         {SolverKind::jacobi, SolverKind::gauss_seidel, SolverKind::southwell, SolverKind::cg, SolverKind::gmres}) {
      SolveOptions options;
      options.kind = kind;
      options.single_precision = single;
      options.tolerance = single ? 2e-5 : 1e-6;
      const Solution solution = solve_radiosity(bench.context, mesh, matrix, options);
      CAPTURE(to_string(kind), single);
      REQUIRE(solution.converged);
      // Columns by reciprocity are the rows' but for the rounding of scales, two of them and products.
      const double scales = kind == SolverKind::southwell ? 1e-6 * solution.largest : 1e-12;
      for (std::size_t c = 0; c < 3; c++) {
        const std::vector<double> exact = test::eliminate(mesh, rows, c);
        for (std::uint32_t s = 0; s < mesh.side_count(); s++) {
          CHECK(std::abs(solution.radiosity[s][c] - exact[s]) <= solution.bounds[s] + scales);
        }
      }
      CHECK(std::isfinite(solution.rounding_bound) == (kind != SolverKind::southwell));
    }
  }
}

TEST_CASE("half precision moves radiosities less than it says, and saves what it says") {
  RadiosityBench bench;
  const FlatScene flat = room();
  for (const FormFactors method : {FormFactors::hybrid, FormFactors::hemicube}) {
    RadiosityOptions options;
    options.mesh.patches = 300;
    options.factors.method = method;
    options.factors.hemicube.batch_bytes = 1U << 20U;
    options.solve.tolerance = 1e-7;
    options.residual_samples = 0;
    const Radiosity single = compute_radiosity(bench.context, flat, options);
    CHECK_FALSE(single.statistics.rounding);
    CHECK(single.solution.rounding_bound == 0.0);
    options.factors.precision = FactorPrecision::half;
    const Radiosity half = compute_radiosity(bench.context, flat, options);
    const RadiosityStatistics& facts = half.statistics;
    REQUIRE(facts.rounding);
    // Symmetric factors stay so.
    CHECK(half.solution.kind == (method == FormFactors::hybrid ? SolverKind::cg : SolverKind::gmres));
    CHECK(half.solution.kind == single.solution.kind);
    double moved = 0.0;
    for (std::size_t s = 0; s < half.solution.radiosity.size(); s++) {
      for (std::size_t c = 0; c < 3; c++) {
        moved = std::max(moved, std::abs(half.solution.radiosity[s][c] - single.solution.radiosity[s][c]));
      }
    }
    const double bound = half.solution.rounding_bound;
    CAPTURE(static_cast<int>(method), moved, bound, half.solution.largest, facts.rounding->largest,
            facts.rounding->mean, facts.rounding->row_change, facts.rounding->row_sum_change);
    CHECK(moved > 0.0);
    CHECK(moved <= bound + single.solution.history.back().bound + half.solution.history.back().bound);
    CHECK(bound <= 2e-3 * half.solution.largest);  // a row's 2^-12, times 1 / (1 - rho) = 5: it tells something
    CHECK(facts.rounding->largest > 0x1p-13);
    if (method == FormFactors::hybrid) CHECK(facts.rounding->largest <= 0x1p-11 * (1.0 + 1e-3));
    CHECK(facts.rounding->mean < facts.rounding->largest);
    CHECK(facts.rounding->row_sum_change < facts.rounding->row_change);
    CHECK(facts.entries == single.statistics.entries);
    CHECK(static_cast<std::int64_t>(single.statistics.factor_bytes) - facts.rounding->bytes_saved ==
          static_cast<std::int64_t>(facts.factor_bytes));
    CHECK(facts.rounding->bytes_saved ==
          static_cast<std::int64_t>(2 * facts.entries) - static_cast<std::int64_t>(4 * facts.rows));
    if (method == FormFactors::hybrid) continue;
    CHECK(facts.factor_bytes <= facts.factor_bytes_at_most);
    CHECK(facts.expected_factor_bytes <= facts.factor_bytes);
    CHECK(facts.factor_bytes - facts.expected_factor_bytes < 100);  // a word a block
  }
}

}  // namespace hemiray
