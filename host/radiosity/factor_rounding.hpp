// Form factors in half precision, and how far they are from those in single.
#pragma once

#include <cstdint>
#include <vector>

#include "host/radiosity/factor_matrix.hpp"
#include "host/radiosity/patch_mesh.hpp"

namespace hemiray {

/// Rounds blocks; context and mesh must outlive it.
class FactorRounder {
 public:
  FactorRounder(Context& context, const PatchMesh& mesh);

  /// Values of F_ij, or with `exchange` of A_i F_ij, to the nearest of 11 bits, ties to even. A row is scaled first, by
  /// a power of two: what is below 2^-28 of its largest value loses bits, what is below 2^-40 becomes 0. Exchange areas
  /// that are symmetric stay so, but for those bits, 2^-38 of a row's largest.
  void round(FactorBlock& block, bool exchange);

 private:
  Context* context_;
  Program program_;
  Buffer<shared::float4> normals_;
};

/// What rounding did to a matrix.
struct FactorRounding {
  double largest = 0.0, mean = 0.0;  ///< of |d| / F_ij, d = rounded F_ij - F_ij
  double row_change = 0.0;           ///< largest sum of |d| of a row
  double row_sum_change = 0.0;       ///< largest |sum of d| of a row
  std::int64_t bytes_saved = 0;      ///< below 0 for rows of fewer than 2 entries
};

FactorRounding rounding_of(const FactorMatrix& matrix);

/// By side: at least the sum of |d| of its row; empty for a matrix in single precision.
std::vector<double> row_changes(const FactorMatrix& matrix);

}  // namespace hemiray
