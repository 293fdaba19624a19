// Meshes cut further: areas kept, no T-junctions, budgets kept, what is not cut as it was; form factors that follow.
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include "host/radiosity/refine_factors.hpp"
#include "tests/radiosity/mesh_checks.hpp"
#include "tests/radiosity/pair_bench.hpp"

namespace hemiray {
namespace {

using test::RadiosityBench;

FlatScene room(Vec3 rho, Vec3 e) {
  FlatScene flat = test::flat_without_materials();
  test::add_room(flat, Vec3(1.0F, 1.5F, 0.7F), test::add_material(flat, rho, e));
  return flat;
}

std::vector<std::uint32_t> some_patches(const PatchMesh& mesh, std::size_t count, unsigned seed) {
  std::vector<std::uint32_t> patches(mesh.patch_count());
  std::iota(patches.begin(), patches.end(), 0U);
  std::shuffle(patches.begin(), patches.end(), std::mt19937(seed));
  patches.resize(std::min(count, patches.size()));
  return patches;
}

// Smallest angle of all triangles [degrees].
double least_angle(const PatchMesh& mesh) {
  double least = 180.0;
  for (const shared::uint4& t : mesh.flat.triangles) {
    const std::array<DVec3, 3> v = {DVec3(test::vertex(mesh.flat, t.x)), DVec3(test::vertex(mesh.flat, t.y)),
                                    DVec3(test::vertex(mesh.flat, t.z))};
    for (std::size_t k = 0; k < 3; k++) {
      const DVec3 a = glm::normalize(v[(k + 1) % 3] - v[k]), b = glm::normalize(v[(k + 2) % 3] - v[k]);
      least = std::min(least, std::acos(glm::dot(a, b)) * 57.29577951308232);
    }
  }
  return least;
}

// What a refined room's rows are by `method`, and what those made all anew are.
struct Rows {
  RefinedMesh refined;
  FactorMatrix old, updated, anew;
  RefinedFactors made;
};

Rows refined_rows(RadiosityBench& bench, FormFactors method) {
  FlatScene flat = room(Vec3(0.8F), Vec3(1.0F));
  test::add_box(flat, Vec3(0.31F, 0.23F, 0.17F), Vec3(0.73F, 0.81F, 0.52F), 0);
  const PatchMesh mesh = make_patch_mesh(flat, {0.0, 300, 0.0});
  FactorOptions options = test::hybrid();
  options.method = method;
  if (method == FormFactors::hemicube) options.hemicube.resolution = 32;
  FactorReport report, again;
  Rows rows;
  rows.old = test::factors_by(bench, mesh, options, report);
  rows.refined = refine_patch_mesh(mesh, some_patches(mesh, 4, 5), 1000);
  Hemicubes hemicubes(bench.context, bench.parallel, bench.builder, rows.refined.mesh, options.hemicube);
  rows.made = refine_factors(bench.context, bench.parallel, hemicubes, rows.old, rows.refined, options);
  rows.anew = test::factors_by(bench, rows.refined.mesh, options, again);
  return rows;
}

}  // namespace

TEST_CASE("a mesh that is refined keeps its areas and its other patches, and has no T-junctions") {
  PatchMesh mesh = make_patch_mesh(room(Vec3(0.5F), Vec3(0.0F)), {0.0, 100, 0.0});
  const double area = test::area_of(mesh), angle = least_angle(mesh);
  for (unsigned round = 0; round < 5; round++) {
    const std::vector<std::uint32_t> chosen = some_patches(mesh, 10, round);
    const std::uint32_t most = mesh.patch_count() + 60;
    const RefinedMesh refined = refine_patch_mesh(mesh, chosen, most);
    const PatchMesh& now = refined.mesh;
    CAPTURE(round, mesh.patch_count(), now.patch_count(), refined.cut);
    CHECK(now.patch_count() <= most);
    CHECK(now.patch_count() > mesh.patch_count() + 20);
    CHECK(test::lonely_edges(now) == 0);
    CHECK(std::abs(test::area_of(now) - area) < 1e-5);
    CHECK(least_angle(now) > 0.5 * angle - 1e-3);  // Rivara 1984
    CHECK(now.side_count() == now.reflectance.size());
    CHECK(refined.parts.size() == now.patch_count() - mesh.patch_count() + refined.cut);
    std::vector<double> areas(mesh.patch_count(), 0.0);
    for (std::uint32_t i = 0; i < now.patch_count(); i++) {
      const bool is_part = std::ranges::binary_search(refined.parts, i);
      const std::uint32_t parent = refined.parents[i];
      areas[parent] += static_cast<double>(now.normals[i].w);
      CHECK(now.faces[i] == mesh.faces[parent]);
      CHECK(now.blocker_of[i] == mesh.blocker_of[parent]);
      if (!is_part) {
        const shared::uint4 &t = now.flat.triangles[i], &u = mesh.flat.triangles[i];
        CHECK((parent == i && t.x == u.x && t.y == u.y && t.z == u.z));
      }
    }
    for (std::uint32_t i = 0; i < mesh.patch_count(); i++) {
      CHECK(areas[i] == Approx(static_cast<double>(mesh.normals[i].w)).epsilon(1e-5));
    }
    mesh = now;
  }
  CHECK(refine_patch_mesh(mesh, some_patches(mesh, 10, 9), mesh.patch_count() + 1).parts.empty());
}

TEST_CASE("form factors of a refined room: only parts' rows are made, a furnace stays exact") {
  RadiosityBench bench;
  for (const FormFactors method : {FormFactors::hybrid, FormFactors::hemicube}) {
    const Rows rows = refined_rows(bench, method);
    const PatchMesh& mesh = rows.refined.mesh;
    const std::vector<FactorRow> updated = read_rows(rows.made.matrix), anew = read_rows(rows.anew),
                                 old = read_rows(rows.old);
    CAPTURE(static_cast<int>(method), mesh.patch_count(), rows.refined.parts.size());
    CHECK(rows.made.made_rows == rows.refined.parts.size());  // fronts
    CHECK(rows.made.matrix.rows() == mesh.patch_count());
    CHECK(rows.made.made_rows < 2 * mesh.patch_count() / 3);
    double off = 0.0;
    for (std::uint32_t i = 0; i < mesh.patch_count(); i++) {
      std::vector<double> difference(mesh.side_count(), 0.0);
      double sum = 0.0;
      CHECK(std::ranges::is_sorted(updated[2 * i]));
      for (const auto& [side, value] : updated[2 * i]) {
        difference[side] += static_cast<double>(value);
        sum += static_cast<double>(value);
      }
      CHECK(std::abs(sum - 1.0) < 1e-4);
      for (const auto& [side, value] : anew[2 * i]) difference[side] -= static_cast<double>(value);
      double l1 = 0.0;
      for (const double d : difference) l1 += std::abs(d);
      off = std::max(off, l1);
      if (method == FormFactors::hybrid || std::ranges::binary_search(rows.refined.parts, i)) continue;
      // By hemicubes what is between patches that are whole has the same bits.
      for (const auto& [side, value] : old[2 * i]) {
        if (std::ranges::binary_search(rows.refined.parts, side / 2)) continue;
        CHECK(std::ranges::binary_search(updated[2 * i], std::pair(side, value)));
      }
    }
    // Pair by pair both come from the same sums, but for rays between partly hidden pairs and what closes rows; cells
    // of hemicubes, ten or so a patch, weigh more.
    INFO("largest L1 distance of a row from one made anew: " << off);
    CHECK(off < (method == FormFactors::hybrid ? 0.05 : 0.15));
    const Solution solution = solve_radiosity(bench.context, mesh, rows.made.matrix, {});
    if (method == FormFactors::hybrid) CHECK(solution.kind == SolverKind::cg);  // symmetric
    for (std::uint32_t i = 0; i < mesh.patch_count(); i++) {
      CHECK(solution.radiosity[2 * i][0] == Approx(5.0).epsilon(1e-3));
    }
  }
}

}  // namespace hemiray
