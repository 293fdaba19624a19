// An implicit surface along a ray as a polynomial of one variable, in multi-precision, and where it is zero.
#pragma once

#include <boost/multiprecision/cpp_bin_float.hpp>
#include <span>
#include <vector>

#include "shared/bvh_types.h"
#include "shared/scene_types.h"

namespace hemiray::stability {

using Precise = boost::multiprecision::cpp_bin_float_50;

/// The sum of coefficients[k] s^k.
using PrecisePolynomial = std::vector<Precise>;

/// The surface of this tape (kernels/shared/polynomial_types.h) at the ray's point t = m + h s, rounded to 50 digits:
/// what is stored on the device is taken for exact. The tape must be sound.
PrecisePolynomial polynomial_along(std::span<const shared::uint4> tape, const shared::Shape& surface,
                                   const shared::QueryRay& ray, double m, double h);

/// Sum of the absolute values that the tape adds up at the ray's point t: what rounding is relative to.
long double size_along(std::span<const shared::uint4> tape, const shared::Shape& surface, const shared::QueryRay& ray,
                       double t);

struct Root {
  long double s = 0;
  bool crosses = true;  ///< the sign changes; if not, what lies here cannot be told from zero by 40 digits
};

/// All roots in [-1, 1], in order, each to 2^-60. Parts are halved until Taylor's form about the middle shows no zero,
/// or a slope without one: in long double with a bound of its rounding, in multi-precision where that is not enough.
std::vector<Root> roots_of(const PrecisePolynomial& p);

Precise value_at(const PrecisePolynomial& p, const Precise& s);

}  // namespace hemiray::stability
