// The search for a device's best profile: one number after the other, each at its fastest value.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "host/gpu/device_profile.hpp"

namespace hemiray::bench {

/// Numbers that are tried together.
struct TuningStep {
  std::string name;
  std::vector<DeviceProfile> candidates;  ///< the first is the one to beat
};

/// What a candidate costs [ms]; may throw DeviceError where the device cannot run it.
using TuningCost = std::function<double(const DeviceProfile&)>;

struct TuningTrial {
  std::string step;
  DeviceProfile profile;
  double cost_ms = 0.0;  ///< infinite where the device failed
  bool chosen = false;
};

/// How much faster a candidate must be to replace what stands: less is noise.
inline constexpr double kTuningGain = 0.02;

/// Turns that each candidate of a step has; the candidates take them in turn, so that whatever else the machine does
/// hits all alike, and the least cost of each counts.
inline constexpr std::size_t kTuningTurns = 3;

/// All steps by name, in the order to go through them.
std::vector<std::string> tuning_step_names();
/// The candidates of a step, from what the earlier ones chose. Throws std::logic_error for a name that is none.
TuningStep tuning_step(const std::string& name, const DeviceProfile& standing);

/// Goes through the steps named from `start` on; returns the best profile and appends every trial.
DeviceProfile tune(const DeviceProfile& start, const std::vector<std::string>& steps, const TuningCost& cost,
                   std::vector<TuningTrial>& trials, const std::function<void(double fraction)>& on_progress = {});

}  // namespace hemiray::bench
