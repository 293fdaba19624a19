// Polynomials in x, y and z as text: "(x^2+y^2+z^2+R^2-r^2)^2 - 4*R^2*(x^2+y^2)". The tree is kept as written.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "host/base/error.hpp"
#include "host/base/vec.hpp"
#include "kernels/shared/polynomial_types.h"

namespace hemiray {

/// Names that an expression may use, and their values.
using ExpressionConstants = std::map<std::string, double, std::less<>>;

/// Longest text of an expression, in bytes.
inline constexpr std::size_t kMaxExpressionLength = 4096;
/// Constants of the tape are zero or within [1 / this, this] in absolute value: float then keeps both their halves.
inline constexpr double kMaxExpressionConstant = 1e30;

/// A polynomial as a tape for the device (shared/polynomial_types.h).
struct Expression {
  std::vector<shared::uint4> tape;
  std::uint32_t degree = 0;  ///< in x, y and z together, 1 to HR_MAX_DEGREE, as written: what cancels is not seen
  std::uint32_t written_degree = 0;  ///< with factors as often as the text has them
  std::uint32_t stack = 0;           ///< most polynomials that wait at once, at most HR_TAPE_STACK
};

/// A fault of an expression: `column` counts bytes of the text from 1, `what()` begins with it.
class ExpressionError : public InputError {
 public:
  ExpressionError(std::size_t column, const std::string& message)
      : InputError("column " + std::to_string(column), message), column_(column) {}
  [[nodiscard]] std::size_t column() const { return column_; }

 private:
  std::size_t column_;
};

/// Whether `name` may name a constant: a letter, then letters, digits and _; not x, y or z.
[[nodiscard]] bool is_constant_name(std::string_view name);

/// Sums, products, division by constants, powers with exponents of 0 to 16, parentheses, unary minus and plus. What is
/// constant is computed at once, in double. Factors of the whole that the text repeats, as p^2 or p*q*p, count once:
/// the surface is the same, its front where the product of the different factors is positive. Throws ExpressionError
/// for anything else, for a degree above HR_MAX_DEGREE, for a text without x, y and z, and for a tape that is too long
/// or needs too deep a stack.
[[nodiscard]] Expression parse_expression(std::string_view text, const ExpressionConstants& constants);

/// The value of the tape at p, in double.
[[nodiscard]] double evaluate(const Expression& expression, const DVec3& p);

}  // namespace hemiray
