#include "host/stability/precise_line.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <utility>

#include "shared/polynomial_types.h"

namespace hemiray::stability {
namespace {

using Long = long double;

// What a number of the tape's stack can do: a polynomial, or the sum of absolute values at a point.
PrecisePolynomial sum(PrecisePolynomial a, const PrecisePolynomial& b, int sign_a, int sign_b) {
  a.resize(std::max(a.size(), b.size()), 0);
  if (sign_a < 0) {
    for (Precise& c : a) c = -c;
  }
  for (std::size_t k = 0; k < b.size(); k++) sign_b < 0 ? a[k] -= b[k] : a[k] += b[k];
  return a;
}
PrecisePolynomial product(const PrecisePolynomial& a, const PrecisePolynomial& b) {
  PrecisePolynomial p(a.size() + b.size() - 1, 0);
  for (std::size_t i = 0; i < a.size(); i++) {
    for (std::size_t j = 0; j < b.size(); j++) p[i + j] += a[i] * b[j];
  }
  return p;
}
Long sum(Long a, Long b, int /*sign_a*/, int /*sign_b*/) { return a + b; }
Long product(Long a, Long b) { return a * b; }

template <typename Number, typename Constant>
Number run_tape(std::span<const shared::uint4> tape, const std::array<Number, 3>& axis, const Constant& constant_of) {
  std::vector<Number> stack;
  const auto pop = [&stack] {
    Number top = std::move(stack.back());
    stack.pop_back();
    return top;
  };
  for (const shared::uint4& op : tape) {
    switch (op.x) {
      case HR_TAPE_X:
      case HR_TAPE_Y:
      case HR_TAPE_Z:
        stack.push_back(axis[op.x]);
        break;
      case HR_TAPE_PUSH:
        stack.push_back(constant_of(op));
        break;
      case HR_TAPE_NEG:
        stack.back() = sum(stack.back(), constant_of({}), -1, 1);
        break;
      case HR_TAPE_SQR:
        stack.back() = product(stack.back(), stack.back());
        break;
      case HR_TAPE_ADD_CONST:
        stack.back() = sum(stack.back(), constant_of(op), 1, 1);
        break;
      case HR_TAPE_MUL_CONST:
        stack.back() = product(stack.back(), constant_of(op));
        break;
      case HR_TAPE_DUP:
        stack.push_back(Number(stack.back()));
        break;
      case HR_TAPE_MUL_UNDER:
        stack.back() = product(stack.back(), stack[stack.size() - 2]);
        break;
      case HR_TAPE_NIP:
        stack.erase(stack.end() - 2);
        break;
      default: {
        const Number top = pop(), under = pop();
        stack.push_back(op.x == HR_TAPE_MUL
                            ? product(under, top)
                            : sum(under, top, op.x == HR_TAPE_RSUB ? -1 : 1, op.x == HR_TAPE_SUB ? -1 : 1));
      }
    }
  }
  return stack.back();
}

template <typename Real>
Real constant(const shared::uint4& op) {
  return Real(std::bit_cast<float>(op.z)) + Real(std::bit_cast<float>(op.w));
}

// Looks for the roots of `c` in Real, which is wrong by `unsure` at most anywhere in [-1, 1]. In the last resort what
// that leaves open is reported as a root that does not cross; else look() gives up.
template <typename Real>
class Search {
 public:
  Search(const PrecisePolynomial& p, const Real& unit, int deepest, bool last_resort)
      : deepest_(deepest), last_resort_(last_resort) {
    Real size = 0;
    for (const Precise& coefficient : p) {
      c_.push_back(static_cast<Real>(coefficient));
      size += abs_of(c_.back());
    }
    // 2 n operations in a row for a coefficient of Taylor's form, n^2 for the sum of the slope's.
    unsure_ = 4 * static_cast<int>(p.size()) * unit * size;
  }

  bool look(const Real& middle, const Real& half, int depth) {
    const std::vector<Real> q = expand(middle, half);
    const auto count = static_cast<int>(q.size());
    Real rest = 0, slope_rest = 0;
    for (int k = 1; k < count; k++) rest += abs_of(q[at(k)]);
    if (abs_of(q[0]) > rest + unsure_) return true;
    if (abs_of(q[0]) + rest <= unsure_) return leave_open(middle, half);
    for (int k = 2; k < count; k++) slope_rest += k * abs_of(q[at(k)]);
    if (count > 1 && abs_of(q[1]) > slope_rest + count * unsure_) return take_one(q, middle, half);
    if (depth == deepest_) return leave_open(middle, half);
    const Real quarter = half / 2;
    return look(middle - quarter, quarter, depth + 1) && look(middle + quarter, quarter, depth + 1);
  }

  struct Bracket {
    Long lo, hi;
    bool crosses;
  };
  [[nodiscard]] const std::vector<Bracket>& brackets() const { return brackets_; }

 private:
  static std::size_t at(int k) { return static_cast<std::size_t>(k); }
  static Real abs_of(const Real& x) { return x < 0 ? Real(-x) : x; }

  // Coefficients of p(middle + half x).
  std::vector<Real> expand(const Real& middle, const Real& half) const {
    std::vector<Real> q = c_;
    for (std::size_t i = 0; i + 1 < q.size(); i++) {
      for (std::size_t j = q.size() - 1; j-- > i;) q[j] += middle * q[j + 1];
    }
    Real power = 1;
    for (Real& coefficient : q) {
      coefficient *= power;
      power *= half;
    }
    return q;
  }

  // The slope has one sign here.
  bool take_one(const std::vector<Real>& q, const Real& middle, const Real& half) {
    Real lo = 0, hi = 0;
    for (std::size_t k = 0; k < q.size(); k++) {
      hi += q[k];
      k % 2 == 0 ? lo += q[k] : lo -= q[k];
    }
    for (const auto& [value, side] : {std::pair<Real, int>{lo, -1}, {hi, 1}}) {
      if (abs_of(value) > unsure_) continue;
      if (!last_resort_) return false;
      const Long end = static_cast<Long>(Real(middle + side * half));
      brackets_.push_back({end, end, true});
      return true;
    }
    if ((lo < 0) != (hi < 0)) add(middle, half, true);
    return true;
  }
  bool leave_open(const Real& middle, const Real& half) {
    if (last_resort_) add(middle, half, false);
    return last_resort_;
  }
  void add(const Real& middle, const Real& half, bool crosses) {
    brackets_.push_back({static_cast<Long>(Real(middle - half)), static_cast<Long>(Real(middle + half)), crosses});
  }

  std::vector<Real> c_;
  Real unsure_ = 0;
  int deepest_;
  bool last_resort_;
  std::vector<Bracket> brackets_;
};

// Value and slope.
std::pair<Precise, Precise> both_at(const PrecisePolynomial& p, const Precise& s) {
  Precise value = 0, slope = 0;
  for (std::size_t k = p.size(); k-- > 0;) {
    slope = slope * s + value;
    value = value * s + p[k];
  }
  return {value, slope};
}

// In a bracket where p is monotonic: Newton's steps where they stay inside, else halving.
Long refine(const PrecisePolynomial& p, Long from, Long to) {
  Precise lo = from, hi = to, s = (lo + hi) / 2;
  const bool rises = value_at(p, lo) < 0;
  for (int i = 0; i < 200 && hi - lo > Precise(0x1p-70L); i++) {
    const auto [value, slope] = both_at(p, s);
    if (value == 0) break;
    ((value < 0) == rises ? lo : hi) = s;
    Precise next = slope == 0 ? lo : Precise(s - value / slope);
    if (i % 4 == 3 || next <= lo || next >= hi) next = (lo + hi) / 2;
    const Precise move = abs(Precise(next - s));
    s = next;
    if (move < Precise(0x1p-70L)) break;
  }
  return static_cast<Long>(s);
}

template <typename Brackets>
std::vector<Root> to_roots(const PrecisePolynomial& p, const Brackets& brackets) {
  std::vector<Root> roots;
  Long end = -2;  // of the bracket before
  bool sharp = true;
  for (const auto& b : brackets) {
    // A root in a common end of two parts, or what cannot be told goes on: once is enough.
    const bool same = b.lo <= end && (!sharp || !b.crosses || b.lo == b.hi);
    const bool now_sharp = b.crosses && b.lo < b.hi;
    if (!same) roots.push_back({now_sharp ? refine(p, b.lo, b.hi) : (b.lo + b.hi) / 2, b.crosses});
    end = b.hi;
    sharp = now_sharp;
  }
  return roots;
}

}  // namespace

PrecisePolynomial polynomial_along(std::span<const shared::uint4> tape, const shared::Shape& surface,
                                   const shared::QueryRay& ray, double m, double h) {
  const std::array<float, 3> o{ray.origin.x, ray.origin.y, ray.origin.z};
  const std::array<float, 3> d{ray.direction.x, ray.direction.y, ray.direction.z};
  const std::array<shared::float4, 3> rows{surface.to_own_x, surface.to_own_y, surface.to_own_z};
  std::array<PrecisePolynomial, 3> axis;
  for (std::size_t i = 0; i < 3; i++) {
    const std::array<float, 3> row{rows[i].x, rows[i].y, rows[i].z};
    Precise at = 0, way = 0;
    for (std::size_t k = 0; k < 3; k++) {
      at += Precise(row[k]) * (Precise(o[k]) + Precise(d[k]) * Precise(m) - Precise(rows[k].w));
      way += Precise(row[k]) * Precise(d[k]) * Precise(h);
    }
    axis[i] = {at, way};
  }
  return run_tape(tape, axis, [](const shared::uint4& op) { return PrecisePolynomial{constant<Precise>(op)}; });
}

long double size_along(std::span<const shared::uint4> tape, const shared::Shape& surface, const shared::QueryRay& ray,
                       double t) {
  const std::array<float, 3> o{ray.origin.x, ray.origin.y, ray.origin.z};
  const std::array<float, 3> d{ray.direction.x, ray.direction.y, ray.direction.z};
  const std::array<shared::float4, 3> rows{surface.to_own_x, surface.to_own_y, surface.to_own_z};
  std::array<Long, 3> axis{};
  for (std::size_t i = 0; i < 3; i++) {
    const std::array<float, 3> row{rows[i].x, rows[i].y, rows[i].z};
    for (std::size_t k = 0; k < 3; k++) {
      axis[i] += std::abs(static_cast<Long>(row[k])) *
                 (std::abs(static_cast<Long>(o[k])) + std::abs(static_cast<Long>(d[k]) * static_cast<Long>(t)) +
                  std::abs(static_cast<Long>(rows[k].w)));
    }
  }
  return run_tape(tape, axis, [](const shared::uint4& op) { return std::abs(constant<Long>(op)); });
}

Precise value_at(const PrecisePolynomial& p, const Precise& s) {
  Precise value = 0;
  for (std::size_t k = p.size(); k-- > 0;) value = value * s + p[k];
  return value;
}

std::vector<Root> roots_of(const PrecisePolynomial& p) {
  constexpr int kDeepest = 32, kDeepestPrecise = 64;
  Search<Long> quick(p, 0x1p-64L, kDeepest, false);
  if (quick.look(0, 1, 0)) return to_roots(p, quick.brackets());
  Search<Precise> slow(p, Precise("1e-48"), kDeepestPrecise, true);
  slow.look(0, 1, 0);
  return to_roots(p, slow.brackets());
}

}  // namespace hemiray::stability
