#include "tests/reference/polynomial_roots.hpp"

#include <algorithm>
#include <cstddef>

namespace hemiray::reference {
namespace {

Precise size_of(const PrecisePolynomial& p) {
  Precise sum = 0;
  for (const Precise& c : p) sum += abs(c);
  return sum;
}

// A root of p in [lo, hi], where it changes its sign: Newton's steps where they stay inside and help, else halving.
Precise root_in(const PrecisePolynomial& p, const PrecisePolynomial& slope, Precise lo, Precise hi) {
  const bool rises = value_at(p, lo) < 0;
  Precise s = (lo + hi) / 2;
  for (int i = 0; i < 400 && hi - lo > Precise("1e-45"); i++) {
    const Precise v = value_at(p, s);
    if (v == 0) return s;
    ((v < 0) == rises ? lo : hi) = s;
    const Precise steepness = value_at(slope, s);
    Precise next = steepness == 0 ? lo : Precise(s - v / steepness);
    if (i % 3 == 2 || next <= lo || next >= hi) next = (lo + hi) / 2;
    if (abs(next - s) < Precise("1e-47")) return next;
    s = next;
  }
  return (lo + hi) / 2;
}

}  // namespace

PrecisePolynomial multiply(const PrecisePolynomial& a, const PrecisePolynomial& b) {
  PrecisePolynomial product(a.size() + b.size() - 1, 0);
  for (std::size_t i = 0; i < a.size(); i++) {
    for (std::size_t j = 0; j < b.size(); j++) product[i + j] += a[i] * b[j];
  }
  return product;
}

Precise value_at(const PrecisePolynomial& p, const Precise& s) {
  Precise v = 0;
  for (std::size_t k = p.size(); k-- > 0;) v = v * s + p[k];
  return v;
}

std::vector<Precise> roots_between(const PrecisePolynomial& p, const Precise& lo, const Precise& hi) {
  std::size_t degree = p.size() - 1;
  while (degree > 0 && p[degree] == 0) degree--;
  if (degree == 0) return {};
  PrecisePolynomial slope(degree);
  for (std::size_t k = 1; k <= degree; k++) slope[k - 1] = p[k] * static_cast<unsigned>(k);
  std::vector<Precise> cuts = {lo};
  for (const Precise& s : roots_between(slope, lo, hi)) cuts.push_back(s);
  cuts.push_back(hi);
  const Precise zero = size_of(p) * Precise("1e-40");
  std::vector<Precise> roots;
  const auto add = [&roots](const Precise& s) {
    if (roots.empty() || s - roots.back() > Precise("1e-30")) roots.push_back(s);
  };
  for (std::size_t i = 0; i < cuts.size(); i++) {
    const Precise v = value_at(p, cuts[i]);
    if (abs(v) <= zero) {
      add(cuts[i]);
    } else if (i + 1 < cuts.size()) {
      const Precise w = value_at(p, cuts[i + 1]);
      if (abs(w) > zero && (v < 0) != (w < 0)) add(root_in(p, slope, cuts[i], cuts[i + 1]));
    }
  }
  return roots;
}

}  // namespace hemiray::reference
