// `hemiray tune -o FILE`: measures a device and writes its profile.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "host/app/commands.hpp"
#include "host/base/atomic_file.hpp"
#include "host/base/clock.hpp"
#include "host/base/error.hpp"
#include "host/base/progress.hpp"
#include "host/base/spelling.hpp"
#include "host/bench/ray_sets.hpp"
#include "host/bench/tuning.hpp"
#include "host/bvh/ray_queries.hpp"
#include "host/gpu/device_list.hpp"
#include "shared/features.h"

namespace hemiray::app {
namespace {

constexpr const char* kExamples = R"(Examples:
  hemiray tune -o profile.json                          measure the default device
  hemiray tune -o profile.json --device gpu --triangles 1000000
  hemiray tune -o profile.json --only max_leaf,packet_groups
  HEMIRAY_PROFILE=profile.json hemiray render SCENE -o out.exr)";

struct TuneArguments {
  std::string output, device;
  std::vector<std::string> only;  // empty: all steps
  std::uint32_t triangles = 250'000, resolution = 512;
  bool quiet = false;
};

// One build of the quality tree, then primary rays in packets, shadow and diffuse rays one by one [ms].
double cost_of(const DeviceInfo& device, const DeviceProfile& profile, const bench::BenchScene& scene,
               const std::vector<bench::RaySet>& sets) {
  Context context(device, profile);
  Parallel parallel(context);
  AccelBuilder builder(context, parallel);
  const DeviceScene device_scene(context, scene.flat, HR_FEATURE_TRIANGLES);
  const Accel accel(builder, device_scene);
  RayQueries single(context, device_scene, accel);
  RayQueries packets(context, device_scene, accel, false, RayGrouping::packets);
  double sum = accel.statistics().build_ms;
  for (const bench::RaySet& set : sets) {
    const auto count = static_cast<std::uint32_t>(set.rays.size());
    const Buffer<shared::QueryRay> rays(context, "rays", std::span<const shared::QueryRay>(set.rays));
    const Buffer<shared::QueryHit> hits(context, "hits", count);
    const Buffer<std::uint32_t> occluded(context, "occluded", count);
    RayQueries& queries = set.common_origin ? packets : single;
    double least = 0.0;
    for (int run = 0; run < 3; run++) {  // the first one compiles
      const double start = steady_ms();
      if (set.any_hit) {
        queries.occluded(rays, occluded, count);
      } else {
        queries.intersect(rays, hits, count);
      }
      context.finish();
      const double took = steady_ms() - start;
      least = run <= 1 ? took : std::min(least, took);
    }
    sum += least;
  }
  return sum;
}

std::vector<bench::RaySet> rays_of(const DeviceInfo& device, const bench::BenchScene& scene, std::uint32_t resolution) {
  Context context(device);
  Parallel parallel(context);
  AccelBuilder builder(context, parallel);
  const DeviceScene device_scene(context, scene.flat, HR_FEATURE_TRIANGLES);
  const Accel accel(builder, device_scene);
  RayQueries queries(context, device_scene, accel);
  return bench::make_ray_sets(scene, resolution,
                              [&](std::span<const shared::QueryRay> rays) { return queries.intersect(rays); });
}

std::string value_of(const bench::TuningTrial& trial) {
  const DeviceProfile& p = trial.profile;
#define HR_NAMED(name, value, least, most, what) \
  if (trial.step == #name) return fmt::format("{}", p.name);
  HR_PROFILE_FIELDS(HR_NAMED)
#undef HR_NAMED
  return "";
}

// The steps asked for, in the order in which they are gone through.
std::vector<std::string> choose_steps(const std::vector<std::string>& only) {
  std::vector<std::string> steps = bench::tuning_step_names();
  for (const std::string& name : only) {
    if (std::find(steps.begin(), steps.end(), name) != steps.end()) continue;
    throw InputError("--only", fmt::format("{} is none of {}", in_quotes(name), fmt::join(steps, ", ")) +
                                   spelling_hint(name, std::vector<std::string_view>(steps.begin(), steps.end())));
  }
  if (!only.empty()) {
    std::erase_if(steps, [&](const auto& name) { return std::find(only.begin(), only.end(), name) == only.end(); });
  }
  return steps;
}

int run_tune(const TuneArguments& given) {
  const std::vector<std::string> steps = choose_steps(given.only);
  if (given.resolution % 32 != 0) throw InputError("--resolution", "not a multiple of 32");
  check_writable(given.output);
  const DeviceInfo device = choose_single_device(given.device, "tune measures");
  const bench::BenchScene scene = bench::procedural_scene("interior", given.triangles);
  const std::vector<bench::RaySet> sets = rays_of(device, scene, given.resolution);
  Progress progress("tune", !given.quiet);
  std::vector<bench::TuningTrial> trials;
  const DeviceProfile best = bench::tune(
      profile_for(device), steps, [&](const DeviceProfile& profile) { return cost_of(device, profile, scene, sets); },
      trials, [&progress](double fraction) { progress.update(fraction, 0.0); });
  progress.finish();
  write_file_atomically(given.output, profile_json(device, best));
  if (given.quiet) return static_cast<int>(ExitCode::ok);
  fmt::print("{}: build of {} triangles and {} sets of rays\n", device.name, scene.flat.triangles.size(), sets.size());
  for (const bench::TuningTrial& trial : trials) {
    const std::string cost = std::isfinite(trial.cost_ms) ? fmt::format("{:9.1f} ms", trial.cost_ms) : "   failed   ";
    fmt::print("  {:<16}{:>6}  {}{}\n", trial.step, value_of(trial), cost, trial.chosen ? "  *" : "");
  }
  fmt::print("wrote {}; use it with HEMIRAY_PROFILE={}\n", given.output, given.output);
  return static_cast<int>(ExitCode::ok);
}

}  // namespace

void add_tune_command(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand("tune", "Measure a device and write its profile");
  const auto given = std::make_shared<TuneArguments>();
  command->add_option("-o,--output", given->output, "Profile to write, JSON")->required()->type_name("FILE");
  command->add_option("--device", given->device, "Index, part of a name, cpu or gpu (default: HEMIRAY_DEVICE)");
  command->add_option("--triangles", given->triangles, "Of the room that is built and traced")
      ->check(CLI::Range(bench::kLeastTriangles, bench::kMostTriangles))
      ->capture_default_str();
  command->add_option("--only", given->only, "Numbers to tune, comma separated (default: all, as the table shows)")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->type_name("NAME");
  command->add_option("--resolution", given->resolution, "Primary rays on a side, a multiple of 32")
      ->check(CLI::Range(32, 4096))
      ->capture_default_str();
  command->add_flag("--quiet", given->quiet, "Print nothing but errors");
  command->footer(kExamples);
  command->callback([given, &exit_code] { exit_code = run_tune(*given); });
}

}  // namespace hemiray::app
