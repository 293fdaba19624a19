// How many rays leak out of closed meshes, for each tracer.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "host/bench/leak_meshes.hpp"
#include "host/bench/run.hpp"

namespace hemiray::bench {

struct LeakResult {
  std::string mesh;    ///< LeakMesh::name
  std::string target;  ///< "edges" or "vertices"
  std::string tracer;
  std::size_t rays = 0;
  std::size_t closest_hit_leaks = 0;
  std::size_t any_hit_leaks = 0;
};

/// Builds each mesh (of 12 cells^2 triangles) with every tracer and counts the leaks of `rays` rays (a multiple of 64)
/// at its edges, and of as many at its vertices, into `results`. Nothing is timed.
void run_leaks(const Tracers& tracers, std::uint32_t cells, std::uint32_t rays, std::vector<LeakResult>& results,
               const Tick& tick = {});

}  // namespace hemiray::bench
