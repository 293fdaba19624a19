// Interleaved timing of tracers: in every round each takes its turn, so that whatever else the machine does hits all
// alike; the first round warms up. Answers are compared before and after.
#pragma once

#include <cstddef>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "host/bench/ray_sets.hpp"
#include "host/bench/spread.hpp"
#include "host/bench/tracer.hpp"

namespace hemiray::bench {

using Tracers = std::vector<std::unique_ptr<Tracer>>;

struct BuildTimes {
  std::string tree;  ///< Tracer::build_name()
  Spread ms;
  std::vector<StageTime> stages;
  std::optional<TreeFacts> facts;
  std::optional<BuildMemory> memory;
};

struct TraceTimes {
  std::string tracer;  ///< Tracer::name()
  std::string rays;    ///< RaySet::name
  std::size_t ray_count = 0;
  Spread ms;
  std::size_t disagreements = 0;  ///< rays answered otherwise than by the reference
  bool valid = false;             ///< few enough
  std::optional<VisitCounts> visits = std::nullopt;
};

/// The rate of the median run [10^6 rays/s].
double mrays_per_second(const TraceTimes& times);

/// Share of rays that two tracers may answer differently: rays through an edge or along a surface fall to one side or
/// the other as the last bit says. A wrong tree or kernel disagrees on far more.
inline constexpr double kMaxDisagreement = 2e-4;
/// Distance by which the same hit may be told differently [in t, relative to max(1, t)].
inline constexpr double kHitTolerance = 1e-3;

/// Both miss, or the same primitive, or |dt| <= kHitTolerance max(1, t).
bool same_hit(const shared::QueryHit& a, const shared::QueryHit& b);
/// Throws std::logic_error if their numbers differ.
std::size_t count_disagreements(std::span<const shared::QueryHit> a, std::span<const shared::QueryHit> b);
std::size_t count_disagreements(std::span<const std::uint32_t> a, std::span<const std::uint32_t> b);

/// Called after each turn; what it throws ends the run, and what was not complete is lost.
using Tick = std::function<void()>;

/// How often everybody takes a turn: `rounds` >= 1 timed times, or fewer, but kLeastRounds, once that has taken
/// `enough_ms`.
struct Effort {
  int rounds = 1;
  double enough_ms = std::numeric_limits<double>::infinity();
};
inline constexpr int kLeastRounds = 3;  ///< a median of fewer says little

/// Builds each tree once untimed, and timed as often as the effort says. One tracer for each build_name() builds; the
/// others share what it has built where they can, and build their own, untimed, where they cannot.
std::vector<BuildTimes> run_builds(const Tracers& tracers, const FlatScene& flat, const Effort& effort,
                                   const Tick& tick = {});

/// The same for tracing the set with each tracer (packets only where origins are common).
/// Answers of the first and of the last round are compared with those of the first tracer that takes part; it is itself
/// valid if it agrees with any other. Alone, nobody is valid. All must have been built.
std::vector<TraceTimes> run_traces(const Tracers& tracers, const RaySet& set, const Effort& effort,
                                   const Tick& tick = {});

}  // namespace hemiray::bench
