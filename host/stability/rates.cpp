#include "host/stability/rates.hpp"

#include <boost/math/distributions/binomial.hpp>

namespace hemiray::stability {

double upper_bound(std::uint64_t count, std::uint64_t n) {
  if (count >= n) return 1.0;
  using Binomial = boost::math::binomial_distribution<double>;
  return Binomial::find_upper_bound_on_p(static_cast<double>(n), static_cast<double>(count), 0.05);
}

}  // namespace hemiray::stability
