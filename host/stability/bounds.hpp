// What a rung may show: nothing, but where the table says otherwise.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "host/stability/rates.hpp"

namespace hemiray::stability {

/// The rates that are held to bounds, by their names in JSON.
struct HeldRate {
  std::string_view name;
  std::uint64_t Tally::*count;
};
inline constexpr HeldRate kHeldRates[] = {
    {"missed", &Tally::missed},      {"false_hit", &Tally::false_hit}, {"wrong_surface", &Tally::wrong_surface},
    {"self_hit", &Tally::self_hit},  {"tunnelled", &Tally::tunnelled}, {"any_hit", &Tally::any_hit},
    {"uncertain", &Tally::uncertain}};

/// And, for implicit surfaces, in how many regions the device says that it cannot tell.
inline constexpr std::string_view kOpenRegions = "open_regions";
inline constexpr double kMostOpenRegions = 1e-3;

/// And how many answers of packets are not those of single rays to the bit. Both are judged; they differ where a ray
/// along an axis lies in the plane between two boxes, of which single rays enter one and packets the other or both, and
/// on slivers, whose t is off by more than boxes are padded: 1 % of the rays of a rung at most.
inline constexpr std::string_view kOtherBits = "other_bits";
inline constexpr double kMostOtherBits = 0.02;

/// More than nothing is expected of these rungs.
struct Allowance {
  std::string_view case_name, rung, rate;
  double most = 0.0;     ///< share of the rays
  std::string_view why;  ///< what single precision cannot do here
};
const std::vector<Allowance>& allowances();

/// The most that a rate may be on a rung; 0 unless the table says otherwise.
double most_allowed(std::string_view case_name, std::string_view rung, std::string_view rate);

/// What is beyond that, such as "missed 3 of 1000000", one for each rate; empty: the rung holds.
std::vector<std::string> broken_bounds(std::string_view case_name, std::string_view rung, const Tally& tally);

}  // namespace hemiray::stability
