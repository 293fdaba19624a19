// What is printed about the refinement of a mesh, and about what a mesh leaves.
#pragma once

#include <nlohmann/json.hpp>

#include <string>

#include "host/radiosity/radiosity.hpp"

namespace hemiray::app {

/// A line a round, and why there are no more; empty where none was asked for.
std::string refinement_table(const RefineReport& report);
nlohmann::ordered_json refinement_json(const RefineReport& report);

nlohmann::ordered_json residual_json(const ContinuousResidual& residual);

}  // namespace hemiray::app
