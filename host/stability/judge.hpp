// Judges what tracers answered to the rays of a rung, by the oracle that knows its primitives.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "host/scene/flat_scene.hpp"
#include "host/stability/aim.hpp"
#include "host/stability/rates.hpp"

namespace hemiray::stability {

/// What one tracer has to answer for.
struct Answers {
  std::vector<shared::QueryHit> hits;
  std::vector<std::uint32_t> occluded;  ///< empty: not asked
};

struct Judged {
  std::vector<Tally> tallies;         ///< of each tracer
  std::vector<std::uint32_t> missed;  ///< rays of which the first one missed something, in order
};

/// Each tracer's answers to the rays, on so many threads. The scene has triangles and spheres, or disks, cones and
/// quadrics, or one implicit surface, and no planes or instances.
Judged judge_all(const FlatScene& flat, const Rays& rays, std::span<const Answers> answers, unsigned threads);

}  // namespace hemiray::stability
