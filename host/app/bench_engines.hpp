// The path tracer's two engines against each other.
#pragma once

#include <vector>

#include "host/bench/results.hpp"
#include "host/gpu/context.hpp"

namespace hemiray::app {

/// Renders two of the shipped scenes with the wavefront and the megakernel engine in turn, 128 x 128 pixels, one sample
/// each: once untimed, then `rounds` times. A pair is valid if the pictures agree. Calls `tick` after each picture.
std::vector<bench::EngineTimes> run_engines(Context& context, int rounds, const bench::Tick& tick);

}  // namespace hemiray::app
