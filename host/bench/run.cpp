#include "host/bench/run.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "host/base/clock.hpp"

namespace hemiray::bench {
namespace {

// When an effort is over; the first round, 0, is not timed.
class Rounds {
 public:
  explicit Rounds(const Effort& effort) : effort_(effort), start_(steady_ms()) {}
  [[nodiscard]] bool end_after(int round) const {
    return round >= effort_.rounds || (round >= kLeastRounds && steady_ms() - start_ >= effort_.enough_ms);
  }

 private:
  Effort effort_;
  double start_;  // [ms]
};

// A tracer's answers to one set; one of the two is empty.
struct Answers {
  std::vector<shared::QueryHit> hits;
  std::vector<std::uint32_t> occlusions;
};

Answers answers_of(Tracer& tracer, bool any_hit) {
  if (any_hit) return {{}, tracer.occlusions()};
  return {tracer.hits(), {}};
}

std::size_t count_disagreements(const Answers& a, const Answers& b) {
  return bench::count_disagreements(a.hits, b.hits) + bench::count_disagreements(a.occlusions, b.occlusions);
}

// The first tracer is the reference for the others.
void verify(const std::vector<Tracer*>& taking_part, const RaySet& set, std::vector<TraceTimes>& times) {
  const Answers reference = answers_of(*taking_part[0], set.any_hit);
  for (std::size_t i = 1; i < taking_part.size(); i++) {
    const std::size_t count = count_disagreements(reference, answers_of(*taking_part[i], set.any_hit));
    times[i].disagreements = std::max(times[i].disagreements, count);
  }
}

void judge(std::vector<TraceTimes>& times) {
  for (std::size_t i = 1; i < times.size(); i++) {
    const double share = static_cast<double>(times[i].disagreements) / static_cast<double>(times[i].ray_count);
    times[i].valid = share <= kMaxDisagreement;
    times[0].valid |= times[i].valid;
  }
}

template <typename T, typename Same>
std::size_t count_differences(std::span<const T> a, std::span<const T> b, Same same) {
  if (a.size() != b.size()) throw std::logic_error("answers to different numbers of rays");
  std::size_t count = 0;
  for (std::size_t i = 0; i < a.size(); i++) count += same(a[i], b[i]) ? 0 : 1;
  return count;
}

}  // namespace

double mrays_per_second(const TraceTimes& times) {
  return static_cast<double>(times.ray_count) / (times.ms.median * 1e3);
}

bool same_hit(const shared::QueryHit& a, const shared::QueryHit& b) {
  if (a.primitive == b.primitive) return true;
  if (a.primitive == HR_NO_PRIMITIVE || b.primitive == HR_NO_PRIMITIVE) return false;
  const double t_a = a.t, t_b = b.t;
  return std::abs(t_a - t_b) <= kHitTolerance * std::max(1.0, t_b);
}

std::size_t count_disagreements(std::span<const shared::QueryHit> a, std::span<const shared::QueryHit> b) {
  return count_differences(a, b, same_hit);
}

std::size_t count_disagreements(std::span<const std::uint32_t> a, std::span<const std::uint32_t> b) {
  return count_differences(a, b, [](std::uint32_t x, std::uint32_t y) { return x == y; });
}

std::vector<BuildTimes> run_builds(const Tracers& tracers, const FlatScene& flat, const Effort& effort,
                                   const Tick& tick) {
  std::vector<Tracer*> builders;
  std::vector<BuildTimes> times;
  for (const auto& tracer : tracers) {
    const std::string tree = tracer->build_name();
    if (std::any_of(times.begin(), times.end(), [&](const BuildTimes& known) { return known.tree == tree; })) continue;
    builders.push_back(tracer.get());
    times.push_back({tree, {}, {}, {}, {}});
  }
  std::vector<std::vector<double>> ms(builders.size());
  const Rounds rounds(effort);
  bool last = false;
  for (int round = 0; !last; round++) {
    for (std::size_t i = 0; i < builders.size(); i++) {
      const double taken = builders[i]->build(flat);
      if (round > 0) ms[i].push_back(taken);
      if (tick) tick();
    }
    last = rounds.end_after(round);
  }
  for (std::size_t i = 0; i < builders.size(); i++) {
    times[i].ms = spread_of(ms[i]);
    times[i].stages = builders[i]->build_stages();
    times[i].facts = builders[i]->facts();
    times[i].memory = builders[i]->build_memory();
  }
  for (const auto& tracer : tracers) {
    if (std::find(builders.begin(), builders.end(), tracer.get()) != builders.end()) continue;
    const auto shares = [&](const Tracer* builder) { return tracer->share_build(*builder); };
    if (std::none_of(builders.begin(), builders.end(), shares)) tracer->build(flat);
  }
  return times;
}

std::vector<TraceTimes> run_traces(const Tracers& tracers, const RaySet& set, const Effort& effort, const Tick& tick) {
  std::vector<Tracer*> taking_part;
  std::vector<TraceTimes> times;
  for (const auto& tracer : tracers) {
    if (tracer->in_packets() && !set.common_origin) continue;
    taking_part.push_back(tracer.get());
    times.push_back({tracer->name(), set.name, set.rays.size(), {}, 0, false, {}});
    tracer->load_rays(set.rays);
  }
  if (taking_part.empty()) return times;
  std::vector<std::vector<double>> ms(taking_part.size());
  const Rounds rounds(effort);
  bool last = false;
  for (int round = 0; !last; round++) {
    for (std::size_t i = 0; i < taking_part.size(); i++) {
      Tracer& tracer = *taking_part[i];
      const double start = steady_ms();
      set.any_hit ? tracer.occluded() : tracer.intersect();
      if (round > 0) ms[i].push_back(steady_ms() - start);
      if (tick) tick();
    }
    last = rounds.end_after(round);
    if (round == 0 || last) verify(taking_part, set, times);
  }
  for (std::size_t i = 0; i < times.size(); i++) {
    times[i].ms = spread_of(ms[i]);
    times[i].visits = taking_part[i]->visits(set.any_hit);
  }
  judge(times);
  return times;
}

}  // namespace hemiray::bench
