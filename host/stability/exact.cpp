#include "host/stability/exact.hpp"

#include <array>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>

namespace hemiray::stability {
namespace {

namespace mp = boost::multiprecision;
// Three factors of differences of floats, 24 bits and 254 exponents each, and their sums: 840 bits.
using Integer = mp::number<mp::cpp_int_backend<1024, 1024, mp::signed_magnitude, mp::unchecked, void>, mp::et_off>;
using Wide = mp::number<mp::cpp_bin_float<200>, mp::et_off>;
using Point = std::array<Integer, 3>;

constexpr int kBits = 24;  // of a float's significand

// The exponent of the last bit of a float.
int last_bit(float x) { return x == 0.0F ? 1000 : std::max(std::ilogb(x), -126) - (kBits - 1); }

int last_bit(Vec3 p) { return std::min({last_bit(p.x), last_bit(p.y), last_bit(p.z)}); }

// x in units of 2^unit, which is not above its last bit.
Integer to_integer(float x, int unit) {
  if (x == 0.0F) return 0;
  const int bit = last_bit(x);
  Integer value = static_cast<long long>(std::ldexp(static_cast<double>(x), -bit));
  return value << (bit - unit);
}

Point to_point(Vec3 p, int unit) { return {to_integer(p.x, unit), to_integer(p.y, unit), to_integer(p.z, unit)}; }

Point operator-(const Point& a, const Point& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }

Point cross(const Point& a, const Point& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

Integer dot(const Point& a, const Point& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

}  // namespace

int exact_edge_sign(Vec3 o, Vec3 d, Vec3 p, Vec3 q) {
  const int unit = std::min({last_bit(o), last_bit(p), last_bit(q)});
  const Point origin = to_point(o, unit);
  return dot(to_point(d, last_bit(d)), cross(to_point(p, unit) - origin, to_point(q, unit) - origin)).sign();
}

bool exact_collinear(Vec3 a, Vec3 b, Vec3 c) {
  const int unit = std::min({last_bit(a), last_bit(b), last_bit(c)});
  if (unit >= 1000) return true;  // all zero
  const Point from = to_point(a, unit);
  const Point n = cross(to_point(b, unit) - from, to_point(c, unit) - from);
  return n[0] == 0 && n[1] == 0 && n[2] == 0;
}

long double exact_plane_t(Vec3 o, Vec3 d, Vec3 a, Vec3 b, Vec3 c) {
  const int unit = std::min({last_bit(o), last_bit(a), last_bit(b), last_bit(c)}), turn = last_bit(d);
  const Point from = to_point(a, unit);
  const Point n = cross(to_point(b, unit) - from, to_point(c, unit) - from);
  const Wide above(dot(from - to_point(o, unit), n)), below(dot(to_point(d, turn), n));
  return std::ldexp(static_cast<long double>(above / below), unit - turn);
}

}  // namespace hemiray::stability
