// Laws that form factors obey, held against those of hemicubes; nothing is changed.
#pragma once

#include <cstdint>
#include <vector>

#include "host/radiosity/factor_matrix.hpp"
#include "host/radiosity/pair_factors.hpp"

namespace hemiray {

struct Violations {
  std::uint64_t entries = 0;             ///< looked at
  std::uint64_t above_one = 0;           ///< F > 1
  std::uint64_t above_area = 0;          ///< A_i F_ij > min(A_i, A_j)
  std::uint64_t above_unobstructed = 0;  ///< by over 1 % more than with nothing in the way
  double reciprocity = 0.0;              ///< largest |A_i F_ij - A_j F_ji| [m^2]
  /// More than 1 % off the pair's own factor: sides close for their size; partly hidden; seen by few rays; else.
  std::uint64_t proximity = 0, visibility = 0, aliasing = 0, point = 0;
};

/// Checks a matrix of hemicubes while the same sides' pairs are computed; all must outlive it.
class Guards {
 public:
  /// `finest`: the largest form factor of a cell.
  Guards(Context& context, const PatchMesh& mesh, const FactorMatrix& raw, const PairSides& sides,
         const PairVisibility& visibility, float finest);

  /// What make_pair_factors() is to call.
  [[nodiscard]] PairWatcher watcher();
  /// Once all batches are done.
  [[nodiscard]] Violations violations();

 private:
  Context* context_;
  const FactorMatrix* raw_;
  const PairSides* sides_;
  const PairVisibility* visibility_;
  float finest_;
  Program program_;
  Buffer<shared::float4> normals_;
  Buffer<shared::uint4> broken_, causes_;
};

/// By side: all rays of its hemicubes met something, as far as the sum of its row tells.
std::vector<bool> closed_rows(const FactorMatrix& raw);

}  // namespace hemiray
