// How far factors are from reciprocity, against a look at every pair.
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>

#include "host/radiosity/solve_checks.hpp"
#include "tests/radiosity/radiosity_bench.hpp"
#include "tests/radiosity/synthetic_system.hpp"

namespace hemiray {
namespace {

using Exchange = std::map<std::pair<std::uint32_t, std::uint32_t>, float>;  // F by row and column

double asymmetry_of(const PatchMesh& mesh, const Exchange& factors) {
  double most = 0.0, apart = 0.0;
  const auto exchange = [&](std::uint32_t i, std::uint32_t j) {
    const auto found = factors.find({i, j});
    return found == factors.end() ? 0.0 : static_cast<double>(mesh.normals[i / 2].w * found->second);
  };
  for (const auto& [pair, value] : factors) {
    const double there = exchange(pair.first, pair.second), here = exchange(pair.second, pair.first);
    most = std::max({most, there, here});
    apart = std::max(apart, std::abs(there - here));
  }
  return apart / most;
}

// Blocks of so many rows, in no order.
FactorMatrix shuffled_matrix(Context& context, const PatchMesh& mesh, const Exchange& factors, std::size_t block_rows,
                             std::mt19937& random) {
  std::map<std::uint32_t, FactorRow> rows;
  for (const auto& [pair, value] : factors) rows[pair.first].emplace_back(pair.second, value);
  std::vector<std::uint32_t> sides;
  for (const auto& [side, row] : rows) sides.push_back(side);
  std::shuffle(sides.begin(), sides.end(), random);
  FactorMatrix matrix;
  matrix.side_count = mesh.side_count();
  for (std::size_t first = 0; first < sides.size(); first += block_rows) {
    SideRows some;
    for (std::size_t k = first; k < std::min(first + block_rows, sides.size()); k++) {
      some.sides.push_back(sides[k]);
      some.rows.push_back(rows[sides[k]]);
    }
    matrix.blocks.push_back(make_block(context, some));
  }
  return matrix;
}

void check_asymmetry(std::uint32_t patches, std::uint32_t partners, std::size_t block_rows, std::uint32_t trials) {
  test::RadiosityBench bench;
  std::mt19937 random(7);
  std::vector<test::SyntheticPatch> sides;
  for (std::uint32_t i = 0; i < patches; i++) {
    sides.push_back({1.0F + 0.5F * static_cast<float>(i % 7), {0.5F, 0.5F, 0.5F}, {0.0F, 0.0F, 0.0F}});
  }
  const PatchMesh mesh = test::synthetic_mesh(sides);
  Exchange symmetric;
  for (std::uint32_t k = 0; k < patches * partners; k++) {
    const auto i = static_cast<std::uint32_t>(random() % mesh.side_count()),
               j = static_cast<std::uint32_t>(random() % mesh.side_count());
    const float exchange = 1.0F + static_cast<float>(random() % 100);
    symmetric[{i, j}] = exchange / mesh.normals[i / 2].w;
    symmetric[{j, i}] = exchange / mesh.normals[j / 2].w;
  }
  CHECK(find_asymmetry(bench.context, mesh, shuffled_matrix(bench.context, mesh, symmetric, block_rows, random), 1.0) <
        1e-6);
  for (std::uint32_t trial = 0; trial < trials; trial++) {
    Exchange factors = symmetric;
    const auto changed = std::next(factors.begin(), static_cast<std::ptrdiff_t>(random() % factors.size()));
    if (trial % 2 == 0) {
      factors.erase(changed);
    } else {
      changed->second *= 1.25F;
    }
    const double expected = asymmetry_of(mesh, factors);
    const FactorMatrix matrix = shuffled_matrix(bench.context, mesh, factors, block_rows, random);
    CAPTURE(trial, expected);
    CHECK(std::abs(find_asymmetry(bench.context, mesh, matrix, 1.0) - expected) < 1e-6);
  }
}

}  // namespace

TEST_CASE("tiny: asymmetry is that of the pair that is farthest apart") { check_asymmetry(12, 6, 9, 4); }

TEST_CASE("asymmetry is found in any two blocks of rows in no order") { check_asymmetry(1000, 5, 1500, 20); }

}  // namespace hemiray
