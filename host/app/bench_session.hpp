// What `hemiray bench` was asked for, and the run that answers it.
#pragma once

#include <cstdint>
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
  int rounds = 1;  ///< timed ones
  std::uint32_t resolution = 1024;
  std::uint32_t leak_rays = 1U << 20U;
};

/// Measures everything in the plan on the context's device, with progress on stderr. Throws InputError for scenes that
/// cannot be loaded or measured, DeviceError where the device fails.
bench::Report run_bench(Context& context, const BenchPlan& plan);

}  // namespace hemiray::app
