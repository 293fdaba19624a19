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

double cost_or_infinity(const TuningCost& cost, const DeviceProfile& profile) {
  try {
    return cost(profile);
  } catch (const DeviceError&) {
    return std::numeric_limits<double>::infinity();  // too large for the device: another candidate wins
  }
}

}  // namespace

std::vector<std::string> tuning_step_names() {
  return {"bvh_width",     "leaf_lanes",    "max_leaf",       "rays_per_item",
          "packet_groups", "cluster_limit", "cluster_chunks", "sort_groups"};
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
  if (name == "sort_groups") return vary(name, standing, &DeviceProfile::sort_groups, {0, 128, 512});
  if (name == "cluster_limit") {
    TuningStep step = vary(name, standing, &DeviceProfile::cluster_limit, {16, 32, 64});
    for (DeviceProfile& candidate : step.candidates) candidate.cluster_keep = candidate.cluster_limit / 2;
    return step;
  }
  throw std::logic_error("no tuning step '" + name + "'");
}

DeviceProfile tune(const DeviceProfile& start, const std::vector<std::string>& steps, const TuningCost& cost,
                   std::vector<TuningTrial>& trials, const std::function<void(double fraction)>& on_progress) {
  DeviceProfile best = start;
  for (std::size_t s = 0; s < steps.size(); s++) {
    const TuningStep step = tuning_step(steps[s], best);
    const std::size_t first = trials.size(), count = step.candidates.size();
    for (const DeviceProfile& candidate : step.candidates) {
      trials.push_back({step.name, candidate, std::numeric_limits<double>::infinity(), false});
    }
    for (std::size_t turn = 0; turn < kTuningTurns * count; turn++) {
      TuningTrial& trial = trials[first + turn % count];
      // What failed once is not asked again.
      if (turn < count || trial.cost_ms < std::numeric_limits<double>::infinity()) {
        trial.cost_ms = std::min(trial.cost_ms, cost_or_infinity(cost, trial.profile));
      }
      const double within = static_cast<double>(turn + 1) / static_cast<double>(kTuningTurns * count);
      if (on_progress) on_progress((static_cast<double>(s) + within) / static_cast<double>(steps.size()));
    }
    std::size_t chosen = first;
    for (std::size_t i = first + 1; i < trials.size(); i++) {
      if (trials[i].cost_ms < trials[chosen].cost_ms * (1.0 - kTuningGain)) chosen = i;
    }
    trials[chosen].chosen = true;
    best = trials[chosen].profile;
  }
  return best;
}

}  // namespace hemiray::bench
