// Form factors pair by pair: exact with nothing in the way, times what visibility lets through.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "host/radiosity/factor_matrix.hpp"
#include "host/radiosity/pair_sides.hpp"
#include "host/radiosity/pair_visibility.hpp"

namespace hemiray {

/// Sums of a row [m^2]: exchange areas A_i F_ij, and of these the parts that may be wrong, by what may be wrong.
struct RowSums {
  double exchange = 0.0;
  double geometry = 0.0;    ///< bound of the quadrature's error
  double sampling = 0.0;    ///< standard errors of the rays of partly hidden pairs, as if they were all one way
  double visibility = 0.0;  ///< what partly hidden pairs exchange
};

struct PairBatch {
  std::uint32_t first = 0, rows = 0;     ///< numbers
  const Buffer<float>* dense = nullptr;  ///< rows x stride exchange areas [m^2]
};

/// Called for each batch of rows with exchange areas with nothing in the way, then with what gets through.
struct PairWatcher {
  std::function<void(const PairBatch&)> unobstructed, obstructed;
};

struct PairFactors {
  FactorMatrix matrix;  ///< its values are exchange areas A_i F_ij [m^2], symmetric to the bit, until scale_pairs()
  std::vector<RowSums> sums;     ///< by number
  std::uint64_t near_pairs = 0;  ///< by the contour integral, each counted once where all rows are wanted
  double pairs_ms = 0.0;
};

/// Rows of the sides that they are wanted of, to all. Symmetric to the bit: A_i F_ij = A_j F_ji. Quadrature is off by
/// HR_PAIR_FAR_ERROR at most, relative. `on_progress` gets the fraction done; returning false leaves the rest of the
/// rows out. Throws DeviceError, InputError for a device without double precision.
PairFactors make_pair_factors(Context& context, Parallel& parallel, const PairSides& sides,
                              const PairVisibility& visibility, const PairWatcher& watcher = {},
                              const std::function<bool(double)>& on_progress = {});

}  // namespace hemiray
