// What tests of pairwise form factors share.
#pragma once

#include <vector>

#include "host/radiosity/form_factors.hpp"
#include "tests/radiosity/radiosity_bench.hpp"
#include "tests/reference/reference_factors.hpp"

namespace hemiray::test {

inline reference::Corners corners_of(const PatchMesh& mesh, std::uint32_t side) {
  const shared::uint4 t = mesh.flat.triangles[side / 2];
  const auto at = [&mesh](std::uint32_t v) -> reference::Point {
    const Vec3 p = vertex(mesh.flat, v);
    return {p.x, p.y, p.z};
  };
  if (side % 2 == 0) return {at(t.x), at(t.y), at(t.z)};
  return {at(t.x), at(t.z), at(t.y)};
}

inline std::vector<std::uint32_t> fronts_of(const PatchMesh& mesh) {
  std::vector<std::uint32_t> fronts;
  for (std::uint32_t i = 0; i < mesh.patch_count(); i++) fronts.push_back(2 * i);
  return fronts;
}

/// Everything sees everything.
inline PairVisibility nothing_in_the_way(Context& context, const PairSides& sides) {
  PairVisibility all;
  const std::vector<std::uint32_t> ones(std::size_t{sides.stride} * sides.stride / 32, 0xFFFFFFFFU);
  all.visible = Buffer<std::uint32_t>(context, "visible", std::span<const std::uint32_t>(ones));
  all.partial = Buffer<std::uint32_t>(context, "partial", ones.size());
  all.partial.clear();
  all.starts = Buffer<std::uint32_t>(context, "starts", sides.count + std::size_t{1});
  all.starts.clear();
  all.columns = Buffer<std::uint32_t>(context, "columns", 1);
  all.shares = Buffer<float>(context, "shares", 1);
  all.errors = Buffer<float>(context, "errors", 1);
  return all;
}

/// Rows of exchange areas [m^2] of all fronts, with nothing in the way, by side.
inline std::vector<FactorRow> unobstructed_exchange(RadiosityBench& bench, const PatchMesh& mesh) {
  const std::vector<std::uint32_t> fronts = fronts_of(mesh);
  const PairSides sides(bench.context, mesh, fronts);
  const PairVisibility all = nothing_in_the_way(bench.context, sides);
  return read_rows(make_pair_factors(bench.context, bench.parallel, sides, all).matrix);
}

/// Factors of all fronts.
inline FactorMatrix factors_by(RadiosityBench& bench, const PatchMesh& mesh, FactorOptions options,
                               FactorReport& report) {
  Hemicubes hemicubes(bench.context, bench.parallel, bench.builder, mesh, options.hemicube);
  return make_form_factors_of(bench.context, bench.parallel, mesh, hemicubes, fronts_of(mesh), options, report);
}

inline FactorOptions hybrid(std::uint32_t few = 16, std::uint32_t many = 256) {
  FactorOptions options;
  options.hemicube.resolution = 16;
  options.visibility.few = few;
  options.visibility.many = many;
  return options;
}

/// Hybrid factors whose partly hidden pairs are all found.
inline FactorOptions by_shafts() {
  FactorOptions options = hybrid(256, 16384);
  options.visibility = hemiray::by_shafts(options.visibility);
  return options;
}

}  // namespace hemiray::test
