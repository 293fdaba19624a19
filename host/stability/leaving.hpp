// Judges rays that left a surface.
#pragma once

#include <cstdint>
#include <vector>

#include "host/bvh/leaving_rays.hpp"
#include "host/stability/rung.hpp"

namespace hemiray::stability {

/// Which way each ray is to go on: a third are mirrored, a third go straight through, the others anywhere on either
/// side; through layers all go on straight, give or take 17 degrees.
std::vector<shared::float4> wanted_ways(const Rung& rung, const Rays& rays, std::uint32_t seed);

/// Rays that hit nothing, or of layers not the first, are left out.
Tally judge_leaving(const Rung& rung, const Rays& rays, const std::vector<shared::float4>& wanted,
                    const LeavingRays& answers);

}  // namespace hemiray::stability
