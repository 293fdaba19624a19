// The path tracer's two engines against each other.
#pragma once

#include <vector>

#include "host/bench/results.hpp"
#include "host/gpu/context.hpp"

namespace hemiray::app {

/// Renders two of the shipped scenes with the wavefront and the megakernel engine in turn, 128 x 128 pixels, one sample
/// each: once untimed, then `rounds` times, into `results`. A pair is valid if the pictures agree. Calls `tick` after
/// each picture.
void run_engines(Context& context, int rounds, std::vector<bench::EngineTimes>& results, const bench::Tick& tick);

}  // namespace hemiray::app
