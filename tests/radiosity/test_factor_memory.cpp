// Memory of form factors: predicted before it is taken, and rows on demand where it is not there.
#include <catch2/catch.hpp>

#include <cmath>

#include "host/base/error.hpp"
#include "host/radiosity/factor_memory.hpp"
#include "host/radiosity/radiosity.hpp"
#include "tests/radiosity/radiosity_bench.hpp"

namespace hemiray {
namespace {

using test::RadiosityBench;

FlatScene lit_room() {
  FlatScene flat = test::flat_without_materials();
  test::add_room(flat, Vec3(1.0F), test::add_material(flat, Vec3(0.7F, 0.5F, 0.3F), Vec3(0.0F)));
  test::add_quad(flat, Vec3(0.3F, 0.9F, 0.3F), Vec3(0.4F, 0, 0), Vec3(0, 0, 0.4F),
                 test::add_material(flat, Vec3(0.0F), Vec3(10.0F)));
  return flat;
}

}  // namespace

TEST_CASE("form factors that do not fit are computed on demand, others are kept, with nearly the same light") {
  RadiosityBench bench;
  RadiosityOptions options;
  options.factors.method = FormFactors::hemicube;
  options.mesh.patches = 300;
  options.factors.hemicube.resolution = 32;
  options.factors.hemicube.batch_bytes = 1U << 20U;  // 85 rows: a batch is not all
  options.residual_samples = 0;
  const Radiosity kept = compute_radiosity(bench.context, lit_room(), options);
  const RadiosityStatistics& facts = kept.statistics;
  CHECK_FALSE(kept.solution.on_demand);
  CHECK(facts.factor_bytes <= facts.factor_bytes_at_most);
  CHECK(facts.factor_limit > facts.factor_bytes_at_most);
  // All rows are there: what was expected last is what was taken, but for a word a block.
  CHECK(facts.expected_factor_bytes <= facts.factor_bytes);
  CHECK(facts.factor_bytes - facts.expected_factor_bytes < 100);

  options.factor_bytes = facts.factor_bytes / 2;
  const Radiosity shot = compute_radiosity(bench.context, lit_room(), options);
  CHECK(shot.solution.on_demand);
  CHECK(shot.solution.kind == SolverKind::southwell);
  REQUIRE(shot.solution.converged);
  CHECK(shot.statistics.factor_bytes == 0);
  CHECK(shot.statistics.rows > 0);
  // Columns by reciprocity are others than those that hemicubes saw: as far apart as hemicubes are wrong.
  double difference = 0.0, sum = 0.0;
  for (std::uint32_t s = 0; s < kept.mesh.side_count(); s++) {
    const auto area = static_cast<double>(kept.mesh.normals[s / 2].w);
    difference += area * std::abs(kept.irradiance[s][0] - shot.irradiance[s][0]);
    sum += area * kept.irradiance[s][0];
  }
  CHECK(difference < 0.05 * sum);
  options.solve.kind = SolverKind::gmres;
  CHECK_THROWS_AS(compute_radiosity(bench.context, lit_room(), options), InputError);
}

TEST_CASE("a stopped progressive solution is shown with its ambient light") {
  RadiosityBench bench;
  RadiosityOptions options;
  options.factors.method = FormFactors::hemicube;
  options.mesh.patches = 200;
  options.factors.hemicube.resolution = 32;
  options.residual_samples = 0;
  options.solve.kind = SolverKind::southwell;
  const auto mean_irradiance = [&](std::uint32_t iterations, bool with_ambient) {
    options.solve.iterations = iterations;
    const Radiosity r = compute_radiosity(bench.context, lit_room(), options);
    double sum = 0.0;
    for (std::uint32_t s = 0; s < r.mesh.side_count(); s++) {
      const auto& h = with_ambient ? r.irradiance : r.solution.irradiance;
      sum += static_cast<double>(r.mesh.normals[s / 2].w) * h[s][0];
    }
    return sum;
  };
  const double end = mean_irradiance(10000, true), bare = mean_irradiance(2, false), shown = mean_irradiance(2, true);
  CHECK(bare < 0.8 * end);
  CHECK(std::abs(shown - end) < 0.3 * std::abs(bare - end));
  CHECK(mean_irradiance(10000, false) == end);
}

}  // namespace hemiray
