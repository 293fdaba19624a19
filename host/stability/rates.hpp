// What a rung counts, and what a count says about the rate behind it.
#pragma once

#include <algorithm>
#include <cstdint>

namespace hemiray::stability {

/// Counts over the rays of one rung. One ray can be in several.
struct Tally {
  std::uint64_t rays = 0;           ///< judged
  std::uint64_t missed = 0;         ///< a hit there surely is, answered by none or by a farther one
  std::uint64_t false_hit = 0;      ///< names what the ray does not meet, or a point farther off it than the bound
  std::uint64_t wrong_surface = 0;  ///< names what is met, but something else is nearer by more than the bound
  std::uint64_t self_hit = 0;       ///< a ray that left a surface meets it again where it left it
  std::uint64_t tunnelled = 0;      ///< a ray that left a surface passes the next one
  std::uint64_t borderline = 0;     ///< answered otherwise than the exact ray, within the bound of an outline
  std::uint64_t any_hit = 0;        ///< asked for any hit, says otherwise than asked for the closest
  std::uint64_t uncertain = 0;      ///< a hit there surely is, and the device says that it cannot tell
  double worst_ulps = 0.0;          ///< of t, over the hits that the exact ray has, too

  void add(const Tally& other) {
    rays += other.rays;
    missed += other.missed;
    false_hit += other.false_hit;
    wrong_surface += other.wrong_surface;
    self_hit += other.self_hit;
    tunnelled += other.tunnelled;
    borderline += other.borderline;
    any_hit += other.any_hit;
    uncertain += other.uncertain;
    worst_ulps = std::max(worst_ulps, other.worst_ulps);
  }
};

/// With 95 % confidence a rate of which `count` of `n` were seen is at most this (Clopper and Pearson 1934, one-sided);
/// 0 of n: about 3 / n. 1 where n is 0.
double upper_bound(std::uint64_t count, std::uint64_t n);

}  // namespace hemiray::stability
