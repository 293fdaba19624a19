// Bounds of rates, and the bounds that rungs are held to.
#include <catch2/catch.hpp>
#include <cmath>

#include "host/stability/bounds.hpp"
#include "host/stability/rates.hpp"

namespace hemiray::stability {
namespace {

// Chance of at most `count` of `n` at a rate.
double at_most(std::uint64_t count, std::uint64_t n, double rate) {
  double sum = 0.0, term = std::pow(1.0 - rate, static_cast<double>(n));
  for (std::uint64_t k = 0; k <= count; k++) {
    sum += term;
    term *= static_cast<double>(n - k) / static_cast<double>(k + 1) * rate / (1.0 - rate);
  }
  return sum;
}

}  // namespace

TEST_CASE("the upper bound of a rate is the one at which so few are seen once in twenty times") {
  for (const auto& [count, n] : {std::pair{0U, 100U}, {0U, 1000U}, {1U, 100U}, {3U, 100U}, {40U, 100U}}) {
    INFO(count << " of " << n);
    CHECK(at_most(count, n, upper_bound(count, n)) == Approx(0.05).epsilon(1e-6));
  }
  CHECK(upper_bound(0, 1'000'000) == Approx(3e-6).epsilon(0.01));
  CHECK(upper_bound(5, 5) == 1.0);
  CHECK(upper_bound(0, 0) == 1.0);
}

TEST_CASE("a rung holds if nothing is wrong, or no more than the table allows") {
  Tally tally;
  CHECK(broken_bounds("scale", "1", tally).size() == 1);  // nothing was judged
  tally.rays = 1000;
  tally.borderline = 1000;
  CHECK(broken_bounds("scale", "1", tally).empty());
  for (const HeldRate& rate : kHeldRates) {
    Tally one = tally;
    one.*rate.count = 1;
    INFO(rate.name);
    CHECK(broken_bounds("scale", "1", one).size() == 1);
  }
  for (const Allowance& allowance : allowances()) {
    INFO(allowance.case_name << ' ' << allowance.rung << ' ' << allowance.rate);
    CHECK(allowance.most > 0.0);
    CHECK(most_allowed(allowance.case_name, allowance.rung, allowance.rate) == allowance.most);
  }
}

}  // namespace hemiray::stability
