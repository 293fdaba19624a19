#include "host/bench/tuning.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>

#include "host/base/error.hpp"

namespace hemiray::bench {
namespace {

using Number = std::uint32_t DeviceProfile::*;

// `standing` first, then itself with each other value of the number.
TuningStep vary(const std::string& name, const DeviceProfile& standing, Number number,
                const std::vector<std::uint32_t>& values) {
  TuningStep step{name, {standing}};
  for (const std::uint32_t value : values) {
    if (value == standing.*number) continue;
    DeviceProfile candidate = standing;
    candidate.*number = value;
    step.candidates.push_back(candidate);
  }
  return step;
}

double lesser_cost(const TuningCost& cost, const DeviceProfile& profile) {
  try {
    const double first = cost(profile);
    return std::min(first, cost(profile));
  } catch (const DeviceError&) {
    return std::numeric_limits<double>::infinity();  // too large for the device: another candidate wins
  }
}

}  // namespace

std::vector<std::string> tuning_step_names() {
  return {"bvh_width", "leaf_lanes", "max_leaf", "rays_per_item", "packet_groups", "cluster_limit", "cluster_chunks"};
}

TuningStep tuning_step(const std::string& name, const DeviceProfile& standing) {
  if (name == "bvh_width") return vary(name, standing, &DeviceProfile::bvh_width, {2, 4, 8});
  if (name == "leaf_lanes") {
    TuningStep step = vary(name, standing, &DeviceProfile::leaf_lanes, {4, 8});
    for (DeviceProfile& candidate : step.candidates) {
      candidate.max_leaf = std::max(candidate.max_leaf, candidate.leaf_lanes);
    }
    return step;
  }
  if (name == "max_leaf") {
    const std::uint32_t lanes = standing.leaf_lanes;
    return vary(name, standing, &DeviceProfile::max_leaf, {std::max(lanes / 2, 1U), lanes, 2 * lanes});
  }
  if (name == "rays_per_item") return vary(name, standing, &DeviceProfile::rays_per_item, {1, 8, 64});
  if (name == "packet_groups") return vary(name, standing, &DeviceProfile::packet_groups, {1, 2, 4});
  if (name == "cluster_chunks") {
    const std::uint32_t chunks = standing.cluster_chunks;
    return vary(name, standing, &DeviceProfile::cluster_chunks, {std::max(chunks / 2, 1U), chunks, 2 * chunks});
  }
  if (name == "cluster_limit") {
    TuningStep step = vary(name, standing, &DeviceProfile::cluster_limit, {16, 32, 64});
    for (DeviceProfile& candidate : step.candidates) candidate.cluster_keep = candidate.cluster_limit / 2;
    return step;
  }
  throw std::logic_error("no tuning step '" + name + "'");
}

DeviceProfile tune(const DeviceProfile& start, const TuningCost& cost, std::vector<TuningTrial>& trials,
                   const std::function<void(double fraction)>& on_progress) {
  DeviceProfile best = start;
  const std::vector<std::string> names = tuning_step_names();
  for (std::size_t s = 0; s < names.size(); s++) {
    const TuningStep step = tuning_step(names[s], best);
    std::size_t chosen = trials.size();
    double least = std::numeric_limits<double>::infinity();
    for (const DeviceProfile& candidate : step.candidates) {
      const double candidate_cost = lesser_cost(cost, candidate);
      if (candidate_cost < least * (1.0 - kTuningGain)) {
        least = candidate_cost;
        best = candidate;
        chosen = trials.size();
      }
      trials.push_back({step.name, candidate, candidate_cost, false});
    }
    if (chosen < trials.size()) trials[chosen].chosen = true;
    if (on_progress) on_progress(static_cast<double>(s + 1) / static_cast<double>(names.size()));
  }
  return best;
}

}  // namespace hemiray::bench
