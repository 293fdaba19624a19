// What is printed about form factors.
#pragma once

#include <nlohmann/json.hpp>

#include <string>

#include "host/radiosity/radiosity.hpp"

namespace hemiray::app {

/// A few lines: rays, pairs, times; of pairwise factors their errors, violations and what enforcement did.
std::string factor_table(const RadiosityStatistics& statistics);
nlohmann::ordered_json factor_json(const FactorReport& report);
nlohmann::ordered_json row_errors_json(const FactorErrors& errors);
/// What half precision costs and saves. `bound`: Solution::rounding_bound.
std::string rounding_line(const FactorRounding& rounding, double bound);
nlohmann::ordered_json rounding_json(const FactorRounding& rounding, double bound);

}  // namespace hemiray::app
