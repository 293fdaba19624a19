#include "host/app/bench_session.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <thread>

#include "host/app/bench_contenders.hpp"
#include "host/app/bench_engines.hpp"
#include "host/base/build_info.hpp"
#include "host/base/error.hpp"
#include "host/base/numbers.hpp"
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
  machine.rounds = plan.effort.rounds;
  return machine;
}

bench::BenchScene file_scene(const std::string& file, std::vector<std::string>& notes) {
  const Scene scene = load_scene(file);
  bench::BenchScene measured{file, flatten_scene(scene), {}};
  FlatScene& flat = measured.flat;
  if (flat.triangles.empty()) throw InputError(file, "has no triangles, which is what the benchmark measures");
  if (!flat.spheres.empty() || !flat.shapes.empty() || !flat.planes.empty()) {
    const std::string shapes = flat.shapes.empty() ? "" : ", " + format_count(flat.shapes.size(), "other shape");
    notes.push_back(fmt::format("{}: measured without its {}{} and {}", file,
                                format_count(flat.spheres.size(), "sphere"), shapes,
                                format_count(flat.planes.size(), "plane")));
    flat.spheres.clear();
    flat.shapes.clear();
    flat.planes.clear();
  }
  measured.view = bench::camera_view(scene, flat);
  return measured;
}

// Thrown out of what is being measured when the user wants no more.
struct Stopped {};

// Estimated work of measuring a scene of so many triangles, beside that of a small one.
double work_of(std::size_t triangles) { return 1.0 + static_cast<double>(triangles) / 1e6; }
constexpr double kEnginesWork = 1.0, kLeaksWork = 2.0;

// Shows how far everything is, and what is known: a progress line on stderr, wiped where a table takes its place.
class Display {
 public:
  Display(const BenchPlan& plan, const BenchOutput& output) : output_(&output), progress_("bench", true) {
    for (const BenchTarget& target : plan.targets) all_ += work_of(target.triangles);
    all_ += (plan.engines ? kEnginesWork : 0.0) + (plan.leaks ? kLeaksWork : 0.0);
  }

  void start_part(double work, std::size_t turns) {
    done_ += part_;
    part_ = work;
    turns_ = turns;
    turn_ = 0;
    check();
  }
  bench::Tick tick() {
    return [this] {
      turn_++;
      const double within = std::min(1.0, static_cast<double>(turn_) / static_cast<double>(std::max(turns_, turn_)));
      progress_.update((done_ + within * part_) / all_, 0.0);
      check();
    };
  }
  void show(const std::string& text) {
    progress_.clear();
    output_->show(text);
  }

 private:
  void check() const {
    if (output_->should_stop()) throw Stopped{};
  }

  const BenchOutput* output_;
  Progress progress_;
  double all_ = 0.0, done_ = 0.0, part_ = 0.0;  // work
  std::size_t turns_ = 1, turn_ = 0;            // of the part
};

void measure_scene(Context& context, const BenchPlan& plan, const ContenderOptions& options, const BenchTarget& target,
                   bench::Report& report, Display& display) {
  const std::size_t notes = report.notes.size();
  const bench::BenchScene scene = target.triangles > 0 ? bench::procedural_scene(target.name, target.triangles)
                                                       : file_scene(target.name, report.notes);
  bench::SceneResults results;
  results.scene = scene.name;
  results.wanted_triangles = target.triangles;
  results.triangles = scene.flat.triangles.size();
  const bench::Tracers tracers = make_tracers(context, options, results.triangles);
  display.start_part(work_of(target.triangles),
                     (static_cast<std::size_t>(plan.effort.rounds) + 1) * tracers.size() * 5);
  for (const auto& tracer : tracers) tracer->offer_instances(scene.instanced ? &*scene.instanced : nullptr);
  results.builds = bench::run_builds(tracers, scene.flat, plan.effort, display.tick());
  display.show(bench::builds_table(results));
  for (std::size_t i = notes; i < report.notes.size(); i++) display.show("note: " + report.notes[i] + "\n");
  report.scenes.push_back(std::move(results));
  bench::Tracer& guide = *tracers.front();
  const auto closest_hits = [&guide](std::span<const shared::QueryRay> rays) {
    guide.load_rays(rays);
    guide.intersect();
    return guide.hits();
  };
  for (const bench::RaySet& set : bench::make_ray_sets(scene, plan.resolution, closest_hits)) {
    const std::vector<bench::TraceTimes> times = bench::run_traces(tracers, set, plan.effort, display.tick());
    display.show(bench::traces_table(times));
    std::vector<bench::TraceTimes>& traces = report.scenes.back().traces;
    traces.insert(traces.end(), times.begin(), times.end());
  }
}

void measure_engines(Context& context, const BenchPlan& plan, bench::Report& report, Display& display) {
  const int rounds = std::min(plan.effort.rounds, kMostEngineRounds);
  display.start_part(kEnginesWork, 4 * (static_cast<std::size_t>(rounds) + 1));
  run_engines(context, rounds, report.engines, display.tick());
  display.show(bench::engines_table(report.engines));
}

void measure_leaks(Context& context, const BenchPlan& plan, const ContenderOptions& options, bench::Report& report,
                   Display& display) {
  const bench::Tracers tracers = make_leak_tracers(context, options);
  display.start_part(kLeaksWork, 8 * tracers.size());
  bench::run_leaks(tracers, bench::kLeakCells, plan.leak_rays, report.leaks, display.tick());
  display.show(bench::leaks_table(report.leaks));
}

ContenderOptions contenders_of(const Context& context, const BenchPlan& plan) {
  ContenderOptions options;
  options.peers = plan.peers;
  options.quick = plan.quick;
  options.only = plan.tracers;
  // Peers run on this machine's processor: with as many threads as the device has where that is the same one.
  const bool on_cpu = context.device().kind == DeviceKind::cpu;
  options.threads = std::max(
      1U, on_cpu ? static_cast<unsigned>(context.device().compute_units) : std::thread::hardware_concurrency());
  return options;
}

}  // namespace

void check_tracers(Context& context, const BenchPlan& plan) {
  const ContenderOptions options = contenders_of(context, plan);
  for (const BenchTarget& target : plan.targets) make_tracers(context, options, target.triangles);
  if (plan.leaks) make_leak_tracers(context, options);
}

bench::Report run_bench(Context& context, const BenchPlan& plan, const BenchOutput& output) {
  const ContenderOptions options = contenders_of(context, plan);
  bench::Report report;
  report.machine = describe(context, plan, options.threads);
  Display display(plan, output);
  display.show(bench::machine_table(report.machine));
  try {
    for (const BenchTarget& target : plan.targets) measure_scene(context, plan, options, target, report, display);
    if (plan.engines) measure_engines(context, plan, report, display);
    if (plan.leaks) measure_leaks(context, plan, options, report, display);
  } catch (const Stopped&) {
    report.interrupted = true;  // a bar is not judged by half of what it needs
    return report;
  }
  report.bars = bench::judge_bars(plan.bars, report.machine.processor_class, report.scenes, report.leaks);
  if (!report.bars.empty()) display.show(bench::bars_table(report.machine, report.bars));
  return report;
}

}  // namespace hemiray::app
