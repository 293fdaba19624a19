// A tape (shared/polynomial_types.h) evaluated in any arithmetic.
#pragma once

#include <bit>
#include <span>
#include <vector>

#include "kernels/shared/polynomial_types.h"

namespace hemiray {

inline double square(double a) { return a * a; }

/// The tape's value at (x, y, z). Number has +, -, *, square() and is made from a double.
template <typename Number>
Number evaluate_tape(std::span<const shared::uint4> tape, const Number& x, const Number& y, const Number& z) {
  std::vector<Number> stack;
  stack.reserve(HR_TAPE_STACK);
  const auto pop = [&stack] {
    const Number value = stack.back();
    stack.pop_back();
    return value;
  };
  for (const shared::uint4& op : tape) {
    // Exact: the two halves have 48 bits together.
    const Number constant(double{std::bit_cast<float>(op.z)} + double{std::bit_cast<float>(op.w)});
    switch (op.x) {
      case HR_TAPE_X:
        stack.push_back(x);
        break;
      case HR_TAPE_Y:
        stack.push_back(y);
        break;
      case HR_TAPE_Z:
        stack.push_back(z);
        break;
      case HR_TAPE_PUSH:
        stack.push_back(constant);
        break;
      case HR_TAPE_NEG:
        stack.back() = -stack.back();
        break;
      case HR_TAPE_SQR:
        stack.back() = square(stack.back());
        break;
      case HR_TAPE_ADD_CONST:
        stack.back() = stack.back() + constant;
        break;
      case HR_TAPE_MUL_CONST:
        stack.back() = stack.back() * constant;
        break;
      case HR_TAPE_DUP:
        stack.push_back(Number(stack.back()));
        break;
      case HR_TAPE_MUL_UNDER:
        stack.back() = stack.back() * stack[stack.size() - 2];
        break;
      case HR_TAPE_NIP:
        stack.erase(stack.end() - 2);
        break;
      default: {
        const Number top = pop(), under = pop();
        stack.push_back(op.x == HR_TAPE_ADD    ? under + top
                        : op.x == HR_TAPE_SUB  ? under - top
                        : op.x == HR_TAPE_RSUB ? top - under
                                               : under * top);
      }
    }
  }
  return stack.back();
}

}  // namespace hemiray
