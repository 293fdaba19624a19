#include "host/stability/bounds.hpp"

#include <fmt/format.h>

namespace hemiray::stability {

const std::vector<Allowance>& allowances() {
  static constexpr std::string_view kCoarse = "there an ulp is 1: vertices are rounded by a quarter of the radius";
  static constexpr std::string_view kGap = "nearer than the bound of the hit point's rounding, 7 roundings of it";
  static const std::vector<Allowance> kTable{
      {"leaving, translation", "1e7", "tunnelled", 0.2, kCoarse},
      {"leaving, translation", "1e7", "self_hit", 0.02, kCoarse},
      {"gap", "5e-7", "tunnelled", 0.05, kGap},
      {"gap", "2e-7", "tunnelled", 1.0, kGap},
      {"nested dielectrics", "1e-6", "tunnelled", 5e-3, kGap},
  };
  return kTable;
}

double most_allowed(std::string_view case_name, std::string_view rung, std::string_view rate) {
  for (const Allowance& one : allowances()) {
    if (one.case_name == case_name && one.rung == rung && one.rate == rate) return one.most;
  }
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
