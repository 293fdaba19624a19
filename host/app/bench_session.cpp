#include "host/app/bench_session.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <thread>

#include "host/app/bench_contenders.hpp"
#include "host/app/bench_engines.hpp"
#include "host/base/build_info.hpp"
#include "host/base/error.hpp"
#include "host/base/progress.hpp"
#include "host/bench/processor.hpp"
#include "host/bench/ray_sets.hpp"
#include "host/scene/load.hpp"

namespace hemiray::app {
namespace {

constexpr int kMostEngineRounds = 5;  // pictures take longer than ray sets, and spread less

bench::Machine describe(const Context& context, const BenchPlan& plan, unsigned threads) {
  const bench::Processor processor = bench::this_processor();
  bench::Machine machine;
  machine.device = context.device().name;
  machine.platform = context.device().platform;
  machine.driver = context.device().driver;
  machine.processor = processor.name;
  machine.processor_class = processor.vector_class;
  machine.threads = threads;
  machine.version = kVersion;
  machine.commit = kCommit;
  if (plan.peers) machine.peer = peer_name();
  machine.rounds = plan.rounds;
  return machine;
}

bench::BenchScene file_scene(const std::string& file, std::vector<std::string>& notes) {
  const Scene scene = load_scene(file);
  bench::BenchScene measured{file, flatten_scene(scene), {}};
  FlatScene& flat = measured.flat;
  if (flat.triangles.empty()) throw InputError(file, "has no triangles, which is what the benchmark measures");
  if (!flat.spheres.empty() || !flat.planes.empty()) {
    notes.push_back(fmt::format("{}: measured without its {} spheres and {} planes", file, flat.spheres.size(),
                                flat.planes.size()));
    flat.spheres.clear();
    flat.planes.clear();
  }
  measured.view = bench::camera_view(scene, flat);
  return measured;
}

// The progress line over all that is to be done, in turns of about equal length.
class Turns {
 public:
  explicit Turns(std::size_t parts) : progress_("bench", true), parts_(parts) {}
  void start_part(std::size_t turns) {
    turns_ = turns;
    turn_ = 0;
  }
  void end_part() { part_++; }
  bench::Tick tick() {
    return [this] {
      turn_++;
      const double within = std::min(1.0, static_cast<double>(turn_) / static_cast<double>(std::max(turns_, turn_)));
      progress_.update((static_cast<double>(part_) + within) / static_cast<double>(parts_), 0.0);
    };
  }

 private:
  Progress progress_;
  std::size_t parts_, part_ = 0, turns_ = 1, turn_ = 0;
};

bench::SceneResults measure(Context& context, const BenchPlan& plan, const ContenderOptions& options,
                            const bench::BenchScene& scene, const BenchTarget& target, Turns& turns) {
  bench::SceneResults results;
  results.scene = scene.name;
  results.wanted_triangles = target.triangles;
  results.triangles = scene.flat.triangles.size();
  const bench::Tracers tracers = make_tracers(context, options, results.triangles);
  turns.start_part((static_cast<std::size_t>(plan.rounds) + 1) * tracers.size() * 5);
  for (const auto& tracer : tracers) tracer->offer_instances(scene.instanced ? &*scene.instanced : nullptr);
  results.builds = bench::run_builds(tracers, scene.flat, plan.rounds, turns.tick());
  bench::Tracer& guide = *tracers.front();
  const auto closest_hits = [&guide](std::span<const shared::QueryRay> rays) {
    guide.load_rays(rays);
    guide.intersect();
    return guide.hits();
  };
  for (const bench::RaySet& set : bench::make_ray_sets(scene, plan.resolution, closest_hits)) {
    for (bench::TraceTimes& times : bench::run_traces(tracers, set, plan.rounds, turns.tick())) {
      results.traces.push_back(std::move(times));
    }
  }
  turns.end_part();
  return results;
}

}  // namespace

bench::Report run_bench(Context& context, const BenchPlan& plan) {
  ContenderOptions options;
  options.peers = plan.peers;
  options.quick = plan.quick;
  // Peers run on this machine's processor: with as many threads as the device has where that is the same one.
  const bool on_cpu = context.device().kind == DeviceKind::cpu;
  options.threads = std::max(
      1U, on_cpu ? static_cast<unsigned>(context.device().compute_units) : std::thread::hardware_concurrency());

  bench::Report report;
  report.machine = describe(context, plan, options.threads);
  Turns turns(plan.targets.size() + (plan.engines ? 1 : 0) + (plan.leaks ? 1 : 0));
  for (const BenchTarget& target : plan.targets) {
    const bench::BenchScene scene = target.triangles > 0 ? bench::procedural_scene(target.name, target.triangles)
                                                         : file_scene(target.name, report.notes);
    report.scenes.push_back(measure(context, plan, options, scene, target, turns));
  }
  if (plan.engines) {
    const int rounds = std::min(plan.rounds, kMostEngineRounds);
    turns.start_part(4 * (static_cast<std::size_t>(rounds) + 1));
    report.engines = run_engines(context, rounds, turns.tick());
    turns.end_part();
  }
  if (plan.leaks) {
    const bench::Tracers tracers = make_leak_tracers(context, options);
    turns.start_part(8 * tracers.size());
    report.leaks = bench::run_leaks(tracers, bench::kLeakCells, plan.leak_rays, turns.tick());
    turns.end_part();
  }
  report.bars = bench::judge_bars(plan.bars, report.machine.processor_class, report.scenes, report.leaks);
  return report;
}

}  // namespace hemiray::app
