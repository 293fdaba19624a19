#include "host/stability/implicit_oracle.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>

#include "host/stability/oracle.hpp"
#include "host/stability/shape_oracle.hpp"

namespace hemiray::stability {
namespace {

// Of the sum of absolute values: a few dozen roundings of float-float, the coarser of the kernels' wide arithmetics.
constexpr long double kNoise = 0x1p-39L;

struct Range {
  long double lo, hi;
};

// Where the ray is in the clip, larger by `grow` of its size.
std::optional<Range> in_clip(const shared::Shape& s, const shared::QueryRay& ray, long double grow) {
  const WideMatrix own = glm::transpose(WideMatrix(wide(s.to_own_x), wide(s.to_own_y), wide(s.to_own_z)));
  const Wide from = wide(ray.origin) - Wide(s.to_own_x.w, s.to_own_y.w, s.to_own_z.w);
  const Wide o = own * from - wide(s.linear), d = own * wide(ray.direction);
  constexpr long double kFar = std::numeric_limits<long double>::infinity();
  Range range{-kFar, kFar};
  const long double middle = -glm::dot(o, d) / glm::dot(d, d);
  if ((s.flags & HR_SHAPE_CLIP_SPHERE) != 0) {
    const long double radius = s.clip.w * (1 + grow);
    const Wide nearest = o + middle * d;
    const long double rest = (radius * radius - glm::dot(nearest, nearest)) / glm::dot(d, d);
    if (!(rest > 0)) return std::nullopt;
    range = {middle - std::sqrt(rest), middle + std::sqrt(rest)};
  } else {
    for (int k = 0; k < 3; k++) {
      const long double half = wide(s.clip)[k] * (1 + grow);
      if (d[k] == 0 && std::abs(o[k]) > half) return std::nullopt;
      if (d[k] == 0) continue;
      const long double a = (-half - o[k]) / d[k], b = (half - o[k]) / d[k];
      range = {std::max(range.lo, std::min(a, b)), std::min(range.hi, std::max(a, b))};
    }
  }
  const long double pad =
      (grow < 0 ? -0.1L : 0.1L) * kAtClip * (std::abs(range.lo - middle) + std::abs(range.hi - middle));
  range = {range.lo - pad, range.hi + pad};
  if (!(range.lo < range.hi)) return std::nullopt;
  return range;
}

}  // namespace

ImplicitOracle::ImplicitOracle(const FlatScene& flat) : surface_(flat.shapes.data()) {
  if (flat.shapes.size() != 1 || surface_->kind != HR_SHAPE_IMPLICIT || !flat.triangles.empty() ||
      !flat.spheres.empty() || !flat.planes.empty()) {
    throw std::logic_error("one implicit surface");
  }
  tape_ = std::span<const shared::uint4>(flat.tapes)
              .subspan(std::bit_cast<std::uint32_t>(surface_->form.x), std::bit_cast<std::uint32_t>(surface_->form.y));
}

ImplicitTruth ImplicitOracle::meet(const shared::QueryRay& ray) const {
  ImplicitTruth truth;
  const auto widest = in_clip(*surface_, ray, kAtClip);
  if (!widest || widest->hi <= ray.origin.w || widest->lo >= ray.direction.w) return truth;
  // A little before t_min, so that what a surface's own rounding hides there is seen as such.
  const double close = 4.0 * ulp_along(ray, ray.origin.w);
  const double lo = std::max(static_cast<double>(widest->lo), ray.origin.w - close);
  const double hi = std::min(static_cast<double>(widest->hi), static_cast<double>(ray.direction.w));
  truth.m = 0.5 * (lo + hi);
  truth.h = 0.5 * (hi - lo) * (1.0 + 1e-9);
  truth.polynomial = polynomial_along(tape_, *surface_, ray, truth.m, truth.h);
  const auto surely = in_clip(*surface_, ray, -kAtClip);
  // Beyond t_min by more than double, in which the kernels compare, can be wrong.
  const double begin = ray.origin.w + 0x1p-20 * close;
  for (const Root& root : roots_of(truth.polynomial)) {
    const auto t = static_cast<double>(truth.m + truth.h * root.s);
    const bool inside = surely && t > static_cast<double>(surely->lo) && t < static_cast<double>(surely->hi);
    if (t <= ray.origin.w && t < begin - 2.0 * 0x1p-20 * close) continue;
    truth.meetings.push_back({t, root.crosses && inside && t > begin && t < ray.direction.w});
  }
  return truth;
}

// Whether the value at t cannot be told from zero.
bool ImplicitOracle::is_noise(const shared::QueryRay& ray, const ImplicitTruth& truth, double t) const {
  if (truth.polynomial.empty()) return false;
  const auto value =
      static_cast<long double>(value_at(truth.polynomial, (Precise(t) - Precise(truth.m)) / Precise(truth.h)));
  return std::abs(value) <= kNoise * size_along(tape_, *surface_, ray, t);
}

void ImplicitOracle::judge(const shared::QueryRay& ray, const ImplicitTruth& truth, const shared::QueryHit& answer,
                           Tally& tally) const {
  tally.rays++;
  const auto first =
      std::find_if(truth.meetings.begin(), truth.meetings.end(), [](const auto& m) { return m.certain; });
  if (answer.primitive == HR_NO_PRIMITIVE) {
    if (first != truth.meetings.end()) {
      tally.missed++;
    } else if (!truth.meetings.empty()) {
      tally.borderline++;
    }
    return;
  }
  const double t = answer.t, ulp = ulp_along(ray, t);
  const ImplicitTruth::Meeting* nearest = nullptr;
  for (const ImplicitTruth::Meeting& m : truth.meetings) {
    if (nearest == nullptr || std::abs(t - m.t) < std::abs(t - nearest->t)) nearest = &m;
  }
  const double off = nearest != nullptr ? std::abs(t - nearest->t) : std::numeric_limits<double>::infinity();
  if (answer.primitive != 0 || !(off <= kBoundUlps * ulp || is_noise(ray, truth, t))) {
    tally.false_hit++;
    return;
  }
  if (nearest != nullptr) tally.worst_ulps = std::max(tally.worst_ulps, off / ulp);
  if (first != truth.meetings.end() && first->t < nearest->t && first->t + kBoundUlps * ulp < t &&
      !is_noise(ray, truth, 0.5 * (first->t + t))) {
    tally.missed++;
  } else if (nearest == nullptr || !nearest->certain) {
    tally.borderline++;
  }
}

}  // namespace hemiray::stability
