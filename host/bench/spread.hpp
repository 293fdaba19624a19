// Repeated measurements in three numbers.
#pragma once

#include <cstddef>
#include <vector>

namespace hemiray::bench {

/// Median, least and most of `runs` measurements.
struct Spread {
  double median = 0.0;
  double least = 0.0;
  double most = 0.0;
  std::size_t runs = 0;
};

/// The median of an even number is the mean of the two in the middle. Throws std::logic_error for none.
Spread spread_of(std::vector<double> values);

}  // namespace hemiray::bench
