// The smallest root of polynomials whose roots are known: the kernels' verdicts against multiprecision.
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "host/gpu/program.hpp"
#include "kernels/shared/polynomial_types.h"
#include "tests/reference/polynomial_roots.hpp"
#include "tests/support/kernel_folder.hpp"

namespace hemiray {
namespace {

using reference::Precise;
using reference::PrecisePolynomial;

// The search as rays make it: in float until something cannot be told, from there on in the wide arithmetic. found[i] =
// {lo, hi} as two floats each; verdict[i] = {kind, 1 if wide, open regions, 0}. `wide_only` leaves out float.
constexpr const char* kProbe = R"(#include "lib/polynomial.h"
kernel void smallest_roots(global const float2* coefficients, global const uint* degree_of, global float4* found,
                           global uint4* verdict, uint wide_only) {
  const uint item = (uint)get_global_id(0);
  global const float2* c = coefficients + item * HR_COEFFICIENTS;
  uint open = 0;
  ulong at = 0;
  int sign = 0;
  if (!wide_only) {
    Poly_f p;
    p.degree = degree_of[item];
    p.error = 0;
    for (uint k = 0; k <= p.degree; k++) p.c[k] = c[k].x + c[k].y;
    p.error = 6e-8f * poly_norm_f(&p);
    const float bound = poly_bound_f(&p);
    Find_f find = poly_search_f(&p, bound, at, HR_PLACE_END, sign, true);
    if (find.kind == HR_FIND_ROOT) poly_refine_f(&p, bound, find.sign_lo, &find.lo, &find.hi);
    if (find.kind != HR_FIND_OPEN) {
      found[item] = (float4)(find.lo, 0, find.hi, 0);
      verdict[item] = (uint4)(find.kind, 0, 0, 0);
      return;
    }
    at = find.next;
    sign = find.sign_next;
  }
  HR_WIDE(Poly) p;
  p.degree = degree_of[item];
  p.error = 0;
  for (uint k = 0; k <= p.degree; k++) p.c[k] = WIDE_OF(c[k].x, c[k].y);
  const WIDE_BOUND bound = HR_WIDE(poly_bound)(&p);
  HR_WIDE(Find) find;
  do {
    find = HR_WIDE(poly_search)(&p, bound, at, HR_PLACE_END, sign, false);
    if (find.kind == HR_FIND_OPEN) open++;
    at = find.next;
    sign = find.sign_next;
  } while (find.kind == HR_FIND_OPEN && at < HR_PLACE_END);
  if (find.kind == HR_FIND_OPEN) find.kind = HR_FIND_NONE;
  if (find.kind == HR_FIND_ROOT) HR_WIDE(poly_refine)(&p, bound, find.sign_lo, &find.lo, &find.hi);
  found[item] = (float4)(TWO_FLOATS(find.lo), TWO_FLOATS(find.hi));
  verdict[item] = (uint4)(find.kind, 1, open, 0);
}
)";
const std::string kDouble =
    "#define WIDE_OF(h, l) ((double)(h) + (double)(l))\n#define WIDE_BOUND double\n"
    "#define TWO_FLOATS(v) (float)(v), (float)((v) - (double)(float)(v))\n";
const std::string kDoubleFloat =
    "#define HR_WITHOUT_DOUBLE\n#define WIDE_OF(h, l) (float2)(h, l)\n#define WIDE_BOUND float\n"
    "#define TWO_FLOATS(v) (v).x, (v).y\n";
const std::string kSturm = "#define HR_POLY_STURM\n";

enum Kind : std::uint32_t { kNone = 0, kRoot = 1, kCluster = 2 };

struct Case {
  PrecisePolynomial exact;  // as the device has it: 48 bits a coefficient
};

struct Verdict {
  Precise lo, hi;
  std::uint32_t kind = 0, wide = 0, open = 0;
};

Case rounded(const PrecisePolynomial& p) {
  Case result;
  for (const Precise& c : p) {
    const auto high = static_cast<float>(c);
    result.exact.push_back(Precise(high) + Precise(static_cast<float>(Precise(c - Precise(high)))));
  }
  return result;
}

PrecisePolynomial with_roots(const std::vector<double>& roots) {
  PrecisePolynomial p = {1};
  for (const double r : roots) p = reference::multiply(p, {Precise(-r), Precise(1)});
  return p;
}

PrecisePolynomial scaled(PrecisePolynomial p, double factor) {
  for (Precise& c : p) c *= factor;
  return p;
}

std::vector<Verdict> ask(const std::vector<Case>& cases, const std::string& defines, bool wide_only) {
  std::vector<shared::float2> coefficients(cases.size() * (HR_MAX_DEGREE + 1), {0.0F, 0.0F});
  std::vector<std::uint32_t> degrees;
  for (std::size_t i = 0; i < cases.size(); i++) {
    degrees.push_back(static_cast<std::uint32_t>(cases[i].exact.size() - 1));
    for (std::size_t k = 0; k < cases[i].exact.size(); k++) {
      const auto high = static_cast<float>(cases[i].exact[k]);
      coefficients[i * (HR_MAX_DEGREE + 1) + k] = {high,
                                                   static_cast<float>(Precise(cases[i].exact[k] - Precise(high)))};
    }
  }
  const test::KernelFolder folder("probe/roots.cl", defines + kProbe);
  Context context(choose_device(""));
  Program program(context, "roots", {"probe/roots.cl"}, {});
  const Buffer<shared::float2> device_coefficients(context, "c", std::span<const shared::float2>(coefficients));
  const Buffer<std::uint32_t> device_degrees(context, "degrees", std::span<const std::uint32_t>(degrees));
  const Buffer<shared::float4> found(context, "found", cases.size());
  const Buffer<shared::uint4> verdict(context, "verdict", cases.size());
  launch(context, program.kernel("smallest_roots"), cases.size(),
         arguments(arg("coefficients", device_coefficients), arg("degree_of", device_degrees), arg("found", found),
                   arg("verdict", verdict), arg("wide_only", std::uint32_t{wide_only ? 1U : 0U})));
  const std::vector<shared::float4> f = found.read();
  const std::vector<shared::uint4> v = verdict.read();
  std::vector<Verdict> result;
  for (std::size_t i = 0; i < cases.size(); i++) {
    result.push_back({Precise(f[i].x) + Precise(f[i].y), Precise(f[i].z) + Precise(f[i].w), v[i].x, v[i].y, v[i].z});
  }
  return result;
}

struct Tally {
  std::size_t open = 0, wide = 0, found = 0, clusters = 0;
  double widest = 0.0;  // bracket of a single root
};

// Nothing missed, nothing invented: what is said without an open region before it is the truth, and where there were
// open ones a root that is reported still is a root.
Tally check(const std::vector<Case>& cases, const std::vector<Verdict>& verdicts) {
  Tally tally;
  for (std::size_t i = 0; i < cases.size(); i++) {
    const Verdict& v = verdicts[i];
    const std::vector<Precise> roots = reference::roots_between(cases[i].exact, -1, 1);
    INFO("polynomial " << i << " of degree " << cases[i].exact.size() - 1 << ", kind " << v.kind << ", wide " << v.wide
                       << ", open " << v.open << ", [" << v.lo << ", " << v.hi << "], " << roots.size()
                       << " roots, first " << (roots.empty() ? Precise(2) : roots[0]));
    if (v.kind == kNone) {
      if (v.open == 0) CHECK(roots.empty());
    } else {
      const auto in = [&v](const Precise& s) { return s >= v.lo && s <= v.hi; };
      CHECK(v.lo < v.hi);
      const auto count = std::count_if(roots.begin(), roots.end(), in);
      CHECK((v.kind == kRoot ? count == 1 : count >= 1));
      if (v.open == 0) CHECK((!roots.empty() && in(roots[0])));
      if (v.kind == kRoot) tally.widest = std::max(tally.widest, static_cast<double>(Precise(v.hi - v.lo)));
      tally.found++;
    }
    tally.open += v.open > 0 ? 1 : 0;
    tally.wide += v.wide;
    tally.clusters += v.kind == kCluster ? 1 : 0;
  }
  return tally;
}

struct Method {
  const char* name;
  std::string defines;
};
std::vector<Method> methods() {
  std::vector<Method> all;
  if (choose_device("").has_fp64) {
    all.push_back({"Bernstein, double", kDouble});
    all.push_back({"Sturm, double", kDouble + kSturm});
  }
  all.push_back({"Bernstein, float-float", kDoubleFloat});
  all.push_back({"Sturm, float-float", kDoubleFloat + kSturm});
  return all;
}

// `most_open`: share of the cases that may end with an open region.
void check_family(const std::string& name, const std::vector<Case>& cases, double most_open) {
  for (const Method& method : methods()) {
    for (const bool wide_only : {false, true}) {
      const Tally tally = check(cases, ask(cases, method.defines, wide_only));
      INFO(name << ", " << method.name << (wide_only ? ", wide only" : "") << ": " << cases.size() << " polynomials, "
                << tally.found << " roots, " << tally.clusters << " clusters, " << tally.wide << " wide, " << tally.open
                << " uncertain, widest bracket " << tally.widest);
      CHECK(static_cast<double>(tally.open) <= most_open * static_cast<double>(cases.size()));
    }
  }
}

class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  double in(double lo, double hi) { return std::uniform_real_distribution<double>(lo, hi)(engine_); }
  // Monic, `count` real roots apart by at least 1e-3, and pairs of complex ones to fill up `degree`.
  PrecisePolynomial separate(int degree, int count) {
    std::vector<double> roots;
    while (static_cast<int>(roots.size()) < count) {
      const double r = in(-1.3, 1.3);
      const auto near = [r](double other) { return std::abs(other - r) < 1e-3 || std::abs(std::abs(r) - 1) < 1e-6; };
      if (std::none_of(roots.begin(), roots.end(), near) && std::abs(std::abs(r) - 1) > 1e-6) roots.push_back(r);
    }
    PrecisePolynomial p = with_roots(roots);
    for (int k = count; k + 2 <= degree; k += 2) {
      const double a = in(-1.0, 1.0), b = in(0.2, 1.0);
      p = reference::multiply(p, {Precise(a * a + b * b), Precise(-2 * a), Precise(1)});
    }
    return p;
  }

 private:
  std::mt19937 engine_;
};

}  // namespace

TEST_CASE("smallest root: separate roots of all degrees are found, each with its certificate") {
  Random random(1);
  std::vector<Case> cases;
  for (int degree = 1; degree <= 16; degree++) {
    for (int i = 0; i < 12; i++)
      cases.push_back(rounded(random.separate(degree, degree % 2 + 2 * (i % (degree / 2 + 1)))));
  }
  check_family("separate", cases, 0.02);
}

TEST_CASE("smallest root: none is invented where a double root was lifted off, none missed where it was cut") {
  Random random(2);
  std::vector<Case> cases;
  for (const double apart : {1e-3, 1e-4, 1e-5, 1e-6}) {
    for (int degree = 2; degree <= 8; degree++) {
      for (int i = 0; i < 4; i++) {
        const double r = random.in(-0.9, 0.9), q = 0.25 * apart * apart;
        const PrecisePolynomial rest = random.separate(degree - 2, 0);
        for (const double gap : {-q, q}) {  // two roots `apart`, or two complex ones
          const PrecisePolynomial pair = {Precise(r) * r + gap, Precise(-2) * r, 1};
          cases.push_back(rounded(reference::multiply(rest, pair)));
        }
      }
    }
  }
  // At 1e-6 the dip is 2.5e-13 of its surroundings, which float-float's bound exceeds.
  check_family("near-double", cases, 0.4);
}

TEST_CASE("smallest root: true double roots are counted as uncertain, triple ones are found") {
  Random random(3);
  std::vector<Case> doubles, triples;
  for (int i = 0; i < 60; i++) {
    const double r = std::round(random.in(-0.9, 0.4) * 256) / 256;  // so that the coefficients are exact
    const double other = r + std::round(random.in(0.05, 0.5) * 64) / 64;
    doubles.push_back(rounded(with_roots({r, r})));
    doubles.push_back(rounded(with_roots({r, r, other})));
    doubles.push_back(rounded(with_roots({r, r, other, other})));
    triples.push_back(rounded(with_roots({r, r, r})));
    triples.push_back(rounded(with_roots({r, r, r, other})));
    triples.push_back(rounded(with_roots({r, r, r, r, r})));
  }
  check_family("double", doubles, 1.0);
  for (const Method& method : methods()) {
    const std::vector<Verdict> verdicts = ask(doubles, method.defines, false);
    INFO(method.name);
    for (std::size_t i = 0; i < doubles.size(); i++) {
      CHECK(verdicts[i].open == (i % 3 == 2 ? 2U : 1U));
      CHECK(verdicts[i].wide == 1);
      if (i % 3 == 1) CHECK(verdicts[i].kind != kNone);
    }
    const Tally tally = check(triples, ask(triples, method.defines, false));
    CHECK(tally.found + tally.open >= triples.size());
    CHECK(tally.clusters > triples.size() / 2);
  }
  check_family("triple", triples, 0.01);  // 1 of 180 in float-float: the search gives up
}

TEST_CASE("smallest root: at the beginning, with leading coefficients of zero, and scaled by 1e7 and 1e-7") {
  Random random(4);
  std::vector<Case> begin, degenerate, large;
  for (int i = 0; i < 60; i++) {
    const double other = random.in(-0.9, 0.9);
    begin.push_back(rounded(with_roots({-1.0, other})));
    begin.push_back(rounded(with_roots({-1.0, -1.0, other})));
    PrecisePolynomial padded = random.separate(3 + i % 4, 1 + i % 3);
    padded.resize(HR_MAX_DEGREE + 1, 0);
    degenerate.push_back(rounded(padded));
    PrecisePolynomial tiny = random.separate(3, 3);
    for (const double c : {1e-9, -1e-12, 1e-25}) tiny.emplace_back(c);
    degenerate.push_back(rounded(tiny));
    for (const double factor : {1e7, 1e-7, -1e20, 1e-20}) {
      large.push_back(rounded(scaled(random.separate(1 + i % 8, 1), factor)));
    }
  }
  degenerate.push_back(rounded(PrecisePolynomial(5, 0)));  // zero everywhere: nothing can be told
  degenerate.push_back(rounded({Precise(1)}));
  // A root exactly at the beginning is there for the oracle, and cannot be told from one just before it.
  check_family("at the beginning", begin, 1.0);
  check_family("leading zeros", degenerate, 0.02);
  check_family("scaled", large, 0.0);
  for (const Method& method : methods()) {
    for (const Verdict& v : ask(begin, method.defines, false)) {
      INFO(method.name);
      CHECK(v.open == 1);
      CHECK(v.kind == kRoot);
    }
  }
}

}  // namespace hemiray
