// All real roots of a polynomial in multiprecision, in the simplest way that cannot go wrong: between neighbouring
// roots of its derivative it is monotonic.
#pragma once

#include <boost/multiprecision/cpp_bin_float.hpp>
#include <vector>

namespace hemiray::reference {

using Precise = boost::multiprecision::cpp_bin_float_50;

/// sum of coefficients[k] s^k.
using PrecisePolynomial = std::vector<Precise>;

[[nodiscard]] PrecisePolynomial multiply(const PrecisePolynomial& a, const PrecisePolynomial& b);
[[nodiscard]] Precise value_at(const PrecisePolynomial& p, const Precise& s);

/// In [lo, hi], in order; places where p touches zero without changing its sign, to 40 digits, count too.
[[nodiscard]] std::vector<Precise> roots_between(const PrecisePolynomial& p, const Precise& lo, const Precise& hi);

}  // namespace hemiray::reference
