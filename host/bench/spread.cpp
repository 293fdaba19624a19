#include "host/bench/spread.hpp"

#include <algorithm>
#include <stdexcept>

namespace hemiray::bench {

Spread spread_of(std::vector<double> values) {
  if (values.empty()) throw std::logic_error("the spread of no values");
  std::sort(values.begin(), values.end());
  const std::size_t n = values.size();
  return {0.5 * (values[(n - 1) / 2] + values[n / 2]), values.front(), values.back(), n};
}

}  // namespace hemiray::bench
