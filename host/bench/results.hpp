// Everything that a run of the benchmark found, as plain data.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "host/bench/run.hpp"

namespace hemiray::bench {

/// One scene at one size.
struct SceneResults {
  std::string scene;
  std::uint32_t wanted_triangles = 0;  ///< 0 for a file
  std::size_t triangles = 0;
  std::vector<BuildTimes> builds;
  std::vector<TraceTimes> traces;
};

/// A shipped scene rendered by both engines.
struct EngineTimes {
  std::string scene, engine;
  std::uint64_t rays = 0;
  Spread ms;  ///< tracing and shading, without compilation
  bool valid = false;
};

/// Where it was measured.
struct Machine {
  std::string device, platform, driver;
  std::string processor, processor_class;
  unsigned threads = 0;
  std::string version, commit;
  std::string peer;  ///< such as "Embree 3.13.5"; empty without
  int rounds = 0;
};

}  // namespace hemiray::bench
