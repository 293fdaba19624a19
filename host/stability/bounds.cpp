#include "host/stability/bounds.hpp"

#include <fmt/format.h>

namespace hemiray::stability {

const std::vector<Allowance>& allowances() {
  static constexpr std::string_view kCoarse = "there an ulp is 1: vertices are rounded by a quarter of the radius";
  static constexpr std::string_view kGap = "nearer than the bound of the hit point's rounding, 7 roundings of it";
  static constexpr std::string_view kInstanceGap =
      "nearer than the bound of the hit point's rounding, the transform's both ways in it";
  static constexpr std::string_view kSharp =
      "sharper than 7.2 degrees: 16 errors off the edge the other face is nearer than both faces' rounding";
  static const std::vector<Allowance> kTable{
      {"leaving, translation", "1e7", "tunnelled", 0.2, kCoarse},
      {"leaving, translation", "1e7", "self_hit", 0.02, kCoarse},
      {"gap", "6e-7", "tunnelled", 0.01, kGap},
      {"gap", "5e-7", "tunnelled", 0.05, kGap},
      {"gap", "4.5e-7", "tunnelled", 0.4, kGap},
      {"gap", "4e-7", "tunnelled", 0.6, kGap},
      {"gap", "3.5e-7", "tunnelled", 0.8, kGap},
      {"gap", "3e-7", "tunnelled", 1.0, kGap},
      {"gap", "2.5e-7", "tunnelled", 1.0, kGap},
      {"gap", "2e-7", "tunnelled", 1.0, kGap},
      {"gap", "1e-7", "tunnelled", 1.0, kGap},
      {"gap, instances", "1.2e-6", "tunnelled", 0.1, kInstanceGap},
      {"gap, instances", "1e-6", "tunnelled", 0.4, kInstanceGap},
      {"gap, instances", "9e-7", "tunnelled", 0.7, kInstanceGap},
      {"gap, instances", "8e-7", "tunnelled", 0.8, kInstanceGap},
      {"gap, instances", "7e-7", "tunnelled", 1.0, kInstanceGap},
      {"gap, instances", "6e-7", "tunnelled", 1.0, kInstanceGap},
      {"gap, instances", "5e-7", "tunnelled", 1.0, kInstanceGap},
      {"leaving, instance place", "1e7", "tunnelled", 0.2, kCoarse},
      {"leaving, instance place", "1e7", "self_hit", 0.02, kCoarse},
      {"leaving, sharp edges", "3.7 degrees", "tunnelled", 0.05, kSharp},
      {"leaving, sharp edges", "3.7 degrees", "self_hit", 1e-3, kSharp},
      {"leaving, sharp edges", "3.7 degrees, instance", "tunnelled", 0.05, kSharp},
      {"leaving, sharp edges", "3.7 degrees, instance", "self_hit", 1e-3, kSharp},
      {"nested dielectrics", "1e-6", "tunnelled", 0.02, kGap},  // 2e-4 on CPUs, 7e-3 where divisions are not rounded
  };
  return kTable;
}

double most_allowed(std::string_view case_name, std::string_view rung, std::string_view rate) {
  for (const Allowance& one : allowances()) {
    if (one.case_name == case_name && one.rung == rung && one.rate == rate) return one.most;
  }
  if (rate == kOpenRegions) return kMostOpenRegions;
  return rate == kOtherBits ? kMostOtherBits : 0.0;
}

std::vector<std::string> broken_bounds(std::string_view case_name, std::string_view rung, const Tally& tally) {
  std::vector<std::string> broken;
  if (tally.rays == 0) broken.emplace_back("no ray was judged");
  for (const HeldRate& rate : kHeldRates) {
    const std::uint64_t count = tally.*rate.count;
    const double most = most_allowed(case_name, rung, rate.name);
    if (static_cast<double>(count) > most * static_cast<double>(tally.rays)) {
      broken.push_back(fmt::format("{} {} of {}", rate.name, count, tally.rays));
    }
  }
  return broken;
}

}  // namespace hemiray::stability
