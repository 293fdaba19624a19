// What `hemiray bench` was asked for, and the run that answers it.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "host/bench/bars.hpp"
#include "host/bench/report.hpp"
#include "host/gpu/context.hpp"

namespace hemiray::app {

/// One scene to measure.
struct BenchTarget {
  std::string name;             ///< of a procedural scene, or a file
  std::uint32_t triangles = 0;  ///< 0: a file
};

struct BenchPlan {
  std::vector<BenchTarget> targets;
  std::vector<bench::Bar> bars;  ///< to judge; empty: none
  bool peers = false, quick = false, leaks = false, engines = false;
  bench::Effort effort;  ///< for the builds and for each set of rays
  std::string tracers;   ///< part of the names of those that take part; empty: all
  std::uint32_t resolution = 1024;
  std::uint32_t leak_rays = 1U << 20U;
};

/// Where a run's output goes while it lasts.
struct BenchOutput {
  std::function<void(const std::string&)> show;  ///< takes a table as soon as it is complete
  std::function<bool()> should_stop;             ///< asked after each turn
};

/// Throws InputError where `tracers` leaves a scene of the plan, or its leaks, without any; a file may turn out to have
/// too many triangles for those it names.
void check_tracers(Context& context, const BenchPlan& plan);

/// Measures everything in the plan on the context's device, with progress on stderr. Stopped, it returns what is
/// complete, without verdicts, as interrupted. Throws InputError for scenes that cannot be loaded or measured,
/// DeviceError where the device fails.
bench::Report run_bench(Context& context, const BenchPlan& plan, const BenchOutput& output);

}  // namespace hemiray::app
