// What may be wrong with the factors between whole areas, told apart: sums over pairs of patches.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "host/radiosity/pair_factors.hpp"

namespace hemiray {

/// The areas that factors are wanted between.
struct FactorGroups {
  std::vector<std::string> names;
  std::vector<std::uint32_t> of_patch;  ///< index into names
};

/// Of a factor, or of an exchange A_i F_ij [m^2].
struct ErrorSplit {
  double geometry = 0.0;    ///< bound of the quadrature's error; what tessellation costs is not in it
  double sampling = 0.0;    ///< standard error of the rays of partly hidden pairs, each with points of its own
  double visibility = 0.0;  ///< kMissedShare of what partly hidden pairs would exchange; by shafts none
};

/// Partly hidden pairs that are not found out lie beside those that are, and cost at most this share of what the latter
/// would exchange with nothing in the way. Between areas 0.004 was measured (tests/radiosity/test_area_errors.cpp).
inline constexpr double kMissedShare = 0.01;

/// Sums errors while make_pair_factors() goes through its batches. What it is made of must outlive it.
class AreaErrors {
 public:
  AreaErrors(Context& context, const FactorGroups& groups, const PairSides& sides, const PairVisibility& visibility);

  /// `batch`: exchange areas with nothing in the way.
  void add(const PairBatch& batch);

  /// Of the exchange areas [m^2] of areas i and j at [i n + j], symmetric.
  [[nodiscard]] std::vector<ErrorSplit> exchange_errors() const;

 private:
  Context* context_;
  const PairSides* sides_;
  const PairVisibility* visibility_;
  std::uint32_t groups_;
  std::vector<std::uint32_t> group_of_;  ///< of sides by number
  Buffer<std::uint32_t> groups_of_;      ///< the same
  Program program_;
  std::vector<ErrorSplit> sums_;  ///< their `sampling` is a variance
};

}  // namespace hemiray
