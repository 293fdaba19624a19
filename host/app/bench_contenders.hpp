// Who takes part in a benchmark.
#pragma once

#include <cstdint>
#include <string>

#include "host/bench/bars.hpp"
#include "host/bench/run.hpp"
#include "host/gpu/context.hpp"

namespace hemiray::app {

struct ContenderOptions {
  bool peers = false;    ///< Embree, too
  bool quick = false;    ///< only what the bars ask for
  unsigned threads = 1;  ///< of the peers
  std::string only;      ///< part of the names of those that take part; empty: all do
};

/// Version of the peer, such as "Embree 3.13.5". Throws InputError naming the package where this build has none.
std::string peer_name();

/// For timing a scene of so many triangles; the first is the one the others are compared with: Embree's default where
/// there are peers, else our watertight single ray. Ours in packets only where the device has them. Nothing is compiled
/// before the first build. Throws InputError if `only` leaves none, or none of ours but packets that there are not.
bench::Tracers make_tracers(Context& context, const ContenderOptions& options, std::size_t triangles);

/// For counting leaks: both triangle tests, single rays and packets, and Embree's default and ROBUST scenes. Otherwise
/// as make_tracers().
bench::Tracers make_leak_tracers(Context& context, const ContenderOptions& options);

/// Names of all that this build can measure, in scenes of any size and on devices with packets.
bench::BarNames contender_names(Context& context, bool peers);

}  // namespace hemiray::app
