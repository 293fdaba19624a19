// Closed rows of exchange areas are made to sum to their side's area, by the least symmetric change.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "host/radiosity/factor_matrix.hpp"
#include "host/radiosity/patch_mesh.hpp"

namespace hemiray {

struct Enforcement {
  std::vector<float> scales;  ///< s of the sides: enforced A_i F_ij = s_i s_j times the raw one
  std::uint32_t sweeps = 0;
  std::uint32_t closed_rows = 0;
  std::uint32_t left_rows = 0;  ///< called closed, but off by more than their slack: not closed everywhere
  double closure_before = 0.0, closure_after = 0.0;  ///< largest |1 - sum F| of closed rows
  double mean_before = 0.0, mean_after = 0.0;        ///< mean |1 - sum F| of closed rows
  double excess_before = 0.0, excess_after = 0.0;    ///< largest sum F - 1 of all rows, 0 if none
};

/// `exchange`: values A_i F_ij, symmetric; they become factors F_ij. `slack`, by side: how far a closed row may
/// be off one, or below 0 for rows that are not closed. With `enforce`, sides whose rows are closed get s_i so that s_i
/// sum_j s_j A_i F_ij = A_i: of all symmetric matrices with these row sums the one nearest to the raw in relative
/// entropy (Sinkhorn 1967 and its symmetric form); other rows have s_i = 1, or less where they would sum to more
/// than 1. Symmetry stays to the bit. Closed rows that are off by more than their slack are left.
/// In half precision exchange areas are what is rounded, alike for both sides of a pair.
Enforcement scale_pairs(Context& context, const PatchMesh& mesh, FactorMatrix& exchange,
                        const std::vector<double>& slack, bool enforce,
                        FactorPrecision precision = FactorPrecision::single);

}  // namespace hemiray
