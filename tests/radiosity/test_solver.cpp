// Radiosity solved: furnaces, spheres whose solution is known, and the bound that the solver promises.
#include <catch2/catch.hpp>

#include <cmath>
#include <numbers>

#include "tests/radiosity/radiosity_bench.hpp"

namespace hemiray {
namespace {

using test::RadiosityBench;

// A sphere seen from inside.
FlatScene hollow_sphere(const PatchMesh& cut) {
  FlatScene flat = cut.flat;
  for (shared::uint4& t : flat.triangles) std::swap(t.y, t.z);
  return flat;
}

}  // namespace

TEST_CASE("a furnace of any shape glows as 1 / (1 - rho)") {
  RadiosityBench bench;
  for (const float rho : {0.0F, 0.5F, 0.9F, 0.99F}) {
    FlatScene flat = test::flat_without_materials();
    test::add_room(flat, Vec3(1.0F, 2.0F, 0.5F), test::add_material(flat, Vec3(rho, 0.5F * rho, 0.0F), Vec3(1.0F)));
    const PatchMesh mesh = make_patch_mesh(flat, {0.0, 300, 0.0});
    HemicubeOptions options;
    options.resolution = 32;
    const FactorMatrix matrix = test::factors_of_fronts(bench, mesh, options);
    for (const SolverKind kind : {SolverKind::jacobi, SolverKind::gauss_seidel}) {
      SolveOptions solve;
      solve.kind = kind;
      solve.tolerance = 1e-5;
      solve.iterations = 5000;
      const Solution solution = solve_radiosity(bench.context, mesh, matrix, solve);
      CAPTURE(rho, static_cast<int>(kind), solution.history.size());
      REQUIRE(solution.converged);
      for (std::uint32_t i = 0; i < mesh.patch_count(); i++) {
        const auto exact = [](double r) { return 1.0 / (1.0 - r); };
        const auto& b = solution.radiosity[std::size_t{2} * i];
        // Rows sum to 1 within a rounding a cell, which 1 / (1 - rho) makes larger.
        CHECK(std::abs(b[0] - exact(static_cast<double>(rho))) < 1e-3 * exact(static_cast<double>(rho)));
        CHECK(std::abs(b[1] - exact(static_cast<double>(0.5F * rho))) < 1e-3 * exact(static_cast<double>(0.5F * rho)));
        CHECK(std::abs(b[2] - 1.0) < 1e-12);
      }
    }
  }
}

TEST_CASE("an integrating sphere with any reflectance and emission is solved, the better the finer") {
  RadiosityBench bench;
  FlatScene ball = test::flat_without_materials();
  test::add_material(ball, Vec3(0.5F), Vec3(0.0F));
  test::add_sphere(ball, Vec3(0.0F), 1.0F);
  double before = 0.0;
  for (const double chord : {0.04, 0.01}) {
    FlatScene flat = hollow_sphere(make_patch_mesh(ball, {100.0, 0, chord}));
    PatchMesh mesh = make_patch_mesh(flat, {100.0, 0, 0.0});
    double rho_mean = 0.0, e_mean = 0.0, area = 0.0;
    for (std::uint32_t i = 0; i < mesh.patch_count(); i++) {
      const Vec3 p = test::vertex(mesh.flat, mesh.flat.triangles[i].x);
      const float rho = 0.45F + 0.4F * p.x, e = p.z > 0.3F ? 1.0F + p.y : 0.0F;
      for (std::uint32_t side = 2 * i; side < 2 * i + 2; side++) {
        mesh.reflectance[side] = {rho, rho, rho, rho};
        mesh.emission[side] = {e, e, e, 1.0F};
      }
      const auto a = static_cast<double>(mesh.normals[i].w);
      area += a;
      rho_mean += a * static_cast<double>(rho);
      e_mean += a * static_cast<double>(e);
    }
    rho_mean /= area;
    e_mean /= area;
    HemicubeOptions options;
    options.resolution = 64;
    const FactorMatrix matrix = test::factors_of_fronts(bench, mesh, options);
    const Solution solution = solve_radiosity(bench.context, mesh, matrix, {});
    REQUIRE(solution.converged);
    // B = E + rho <E> / (1 - <rho>): every patch sees every other as its share of the area.
    double squares = 0.0;
    for (std::uint32_t i = 0; i < mesh.patch_count(); i++) {
      const double exact = static_cast<double>(mesh.emission[std::size_t{2} * i].x) +
                           static_cast<double>(mesh.reflectance[std::size_t{2} * i].x) * e_mean / (1.0 - rho_mean);
      const double error = solution.radiosity[std::size_t{2} * i][0] - exact;
      squares += static_cast<double>(mesh.normals[i].w) * error * error;
    }
    const double error = std::sqrt(squares / area);
    CAPTURE(chord, mesh.patch_count(), error, before);
    if (before > 0.0) {
      CHECK(error < 0.5 * before);
      CHECK(error < 0.01);
    }
    before = error;
  }
}

TEST_CASE("the bound holds at every iteration and is sharp at the end") {
  RadiosityBench bench;
  FlatScene flat = test::flat_without_materials();
  const std::uint32_t grey = test::add_material(flat, Vec3(0.95F, 0.7F, 0.2F), Vec3(0.0F));
  test::add_room(flat, Vec3(1.0F), grey);
  test::add_quad(flat, Vec3(0.4F, 0.95F, 0.4F), Vec3(0.2F, 0, 0), Vec3(0, 0, 0.2F),
                 test::add_material(flat, Vec3(0.0F), Vec3(10.0F)));
  const PatchMesh mesh = make_patch_mesh(flat, {0.0, 200, 0.0});
  const FactorMatrix matrix = test::factors_of_fronts(bench, mesh, {});
  SolveOptions best;
  best.tolerance = 1e-11;
  best.iterations = 5000;
  const Solution exact = solve_radiosity(bench.context, mesh, matrix, best);
  REQUIRE(exact.converged);
  for (const std::uint32_t iterations : {0U, 1U, 5U, 50U}) {
    SolveOptions some;
    some.kind = SolverKind::jacobi;
    some.iterations = iterations;
    some.tolerance = 1e-9;
    const Solution solution = solve_radiosity(bench.context, mesh, matrix, some);
    double worst = 0.0;
    for (std::uint32_t s = 0; s < mesh.side_count(); s++) {
      for (std::size_t c = 0; c < 3; c++) {
        const double error = std::abs(solution.radiosity[s][c] - exact.radiosity[s][c]);
        CHECK(error <= solution.bounds[s] + exact.bounds[s]);
        worst = std::max(worst, error);
      }
    }
    CAPTURE(iterations, worst, solution.history.back().bound);
    if (iterations == 50) CHECK(solution.history.back().bound < 20.0 * worst);
  }
}

TEST_CASE("rows are computed where light comes, and nowhere else") {
  RadiosityBench bench;
  FlatScene flat = test::flat_without_materials();
  const std::uint32_t grey = test::add_material(flat, Vec3(0.5F), Vec3(0.0F));
  test::add_room(flat, Vec3(1.0F), grey);
  const std::size_t room = flat.triangles.size();
  test::add_quad(flat, Vec3(0.4F, 0.9F, 0.4F), Vec3(0.2F, 0, 0), Vec3(0, 0, 0.2F),
                 test::add_material(flat, Vec3(0.0F), Vec3(10.0F)));
  const PatchMesh mesh = make_patch_mesh(flat, {0.0, 100, 0.0});
  Hemicubes hemicubes(bench.context, bench.parallel, bench.builder, mesh, {});
  std::vector<std::uint32_t> sources;
  for (std::uint32_t s = 0; s < mesh.side_count(); s++) {
    if (mesh.emission[s].x > 0.0F) sources.push_back(s);
  }
  const FactorMatrix matrix = hemicubes.rows_reached_from(sources);
  const std::vector<FactorRow> rows = read_rows(matrix);
  for (std::uint32_t s = 0; s < mesh.side_count(); s++) {
    const bool wall_outside = s % 2 == 1 && mesh.faces[s / 2] < room;
    INFO("side " << s);
    CHECK(rows[s].empty() == wall_outside);
  }
}

}  // namespace hemiray
