// `hemiray bench`: builds and traces, measured and verified, beside Embree where it is there.
#include <cstdio>

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>

#include "host/app/bench_contenders.hpp"
#include "host/app/bench_plot.hpp"
#include "host/app/bench_session.hpp"
#include "host/app/commands.hpp"
#include "host/app/data_files.hpp"
#include "host/base/atomic_file.hpp"
#include "host/base/error.hpp"
#include "host/base/interrupt.hpp"
#include "host/base/read_file.hpp"
#include "host/base/spelling.hpp"
#include "host/bench/processor.hpp"
#include "host/gpu/device_list.hpp"

namespace hemiray::app {
namespace {

namespace fs = std::filesystem;

constexpr const char* kExamples = R"(Examples:
  hemiray bench --quick                              the room of the bars at 250k and 1M triangles
  hemiray bench --quick --peers --bars               the same beside Embree, held to bench/bars.json
  hemiray bench --leaks --peers --triangles 250k interior --json bench.json --plot plots
  hemiray bench model.glb terrain --triangles 10k,1M,10M
  hemiray bench interior --triangles 20M --tracers quality/watertight --rounds 1

SCENE is interior, terrain, hair, instances, or a file; without any, all four and both engines of `render` are measured.
Every time is the median of interleaved rounds; every answer is compared with a second traversal's, and a run that
differs is INVALID. With --bars the exit code is 3 unless every bar that was measured is reached.)";

constexpr int kQuickRounds = 7, kRounds = 11;
// Six parts at two sizes: with this much for each, --quick ends within five minutes where others work, too.
constexpr double kQuickMs = 6'000.0;
constexpr std::size_t kMaxBarsBytes = std::size_t{1} << 20U;

struct BenchArguments {
  bool quick = false, peers = false, leaks = false;
  std::string json, csv, plot, device, tracers;
  std::vector<std::string> bars;  // empty: the option without a file
  bool judged = false;
  std::vector<std::string> triangles, scenes;
  int rounds = 0;  // 0: by --quick
  std::uint32_t resolution = bench::kDefaultResolution, leak_rays = bench::kLeakRays;
};

// "250000", "250k", "1M".
std::uint32_t parse_triangles(const std::string& text) {
  const std::string place = "--triangles";
  std::string digits = text;
  std::uint64_t factor = 1;
  if (!digits.empty() && (digits.back() == 'k' || digits.back() == 'M')) {
    factor = digits.back() == 'k' ? 1000 : 1'000'000;
    digits.pop_back();
  }
  if (digits.empty() || digits.size() > 8 || digits.find_first_not_of("0123456789") != std::string::npos) {
    throw InputError(place, fmt::format("'{}' is not a number of triangles; write such as 250000, 250k or 1M", text));
  }
  const std::uint64_t count = std::stoull(digits) * factor;
  if (count < bench::kLeastTriangles || count > bench::kMostTriangles) {
    throw InputError(place,
                     fmt::format("{} is not from {} to {}", text, bench::kLeastTriangles, bench::kMostTriangles));
  }
  return static_cast<std::uint32_t>(count);
}

bool is_procedural(const std::string& name) {
  const auto names = bench::procedural_scene_names();
  return std::find(names.begin(), names.end(), name) != names.end();
}

std::vector<BenchTarget> choose_targets(const BenchArguments& given) {
  std::vector<std::string> scenes = given.scenes;
  if (scenes.empty() && given.quick) scenes = {"interior"};
  if (scenes.empty()) scenes.assign(bench::procedural_scene_names().begin(), bench::procedural_scene_names().end());
  std::vector<std::uint32_t> sizes;
  for (const std::string& text : given.triangles) sizes.push_back(parse_triangles(text));
  if (sizes.empty() && given.quick) sizes = {250'000, 1'000'000};
  if (sizes.empty()) sizes = {10'000, 50'000, 250'000, 1'000'000, 3'000'000, 10'000'000};
  std::vector<BenchTarget> targets;
  for (const std::string& scene : scenes) {
    if (is_procedural(scene)) {
      for (const std::uint32_t size : sizes) targets.push_back({scene, size});
      continue;
    }
    std::error_code ignored;
    if (!fs::exists(scene, ignored)) {
      throw InputError("SCENE", in_quotes(scene) + " is neither a file nor a scene of the benchmark" +
                                    spelling_hint(scene, bench::procedural_scene_names()));
    }
    targets.push_back({scene, 0});
  }
  const auto is_file = [](const BenchTarget& target) { return target.triangles == 0; };
  if (!given.triangles.empty() && std::all_of(targets.begin(), targets.end(), is_file)) {
    throw InputError("--triangles",
                     "only files are given, which have their own size; leave it out, or name a scene of " +
                         fmt::format("{}", fmt::join(bench::procedural_scene_names(), ", ")));
  }
  return targets;
}

// Bars that are ratios hold the interior, at their sizes, on processors.
void check_ratios(const std::vector<bench::Bar>& bars, const std::string& file, const std::vector<BenchTarget>& targets,
                  const DeviceInfo& device) {
  const bench::Processor processor = bench::this_processor();
  const std::vector<std::uint32_t> sizes = bench::bar_sizes(bars, processor.vector_class);
  if (sizes.empty()) {
    throw InputError("--bars", fmt::format("{} has no bars for this processor, {} ({})", file, processor.name,
                                           processor.vector_class.empty() ? "no AVX2" : processor.vector_class));
  }
  const bool any = std::any_of(targets.begin(), targets.end(), [&](const BenchTarget& target) {
    return target.name == "interior" && std::find(sizes.begin(), sizes.end(), target.triangles) != sizes.end();
  });
  if (!any) {
    throw InputError("--bars", fmt::format("bars hold the scene interior at {} triangles, which is not measured here",
                                           fmt::join(sizes, " or ")));
  }
  if (device.kind != DeviceKind::cpu) {
    throw InputError("--bars", fmt::format("bars are for processors, {} is none", device.name));
  }
}

std::vector<bench::Bar> load_bars(Context& context, const BenchArguments& given,
                                  const std::vector<BenchTarget>& targets) {
  const std::string file =
      given.bars.empty() || given.bars[0].empty() ? data_file("bench/bars.json").string() : given.bars[0];
  const std::vector<std::uint8_t> bytes = read_file(file, kMaxBarsBytes);
  std::vector<bench::Bar> bars = bench::parse_bars({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, file);
  const bool has_ratios =
      std::any_of(bars.begin(), bars.end(), [](const bench::Bar& bar) { return bar.kind != bench::BarKind::leaks; });
  if (has_ratios && !given.peers) throw InputError("--bars", "bars are ratios to Embree's figures: give --peers, too");
  if (!has_ratios && !given.leaks) throw InputError("--bars", file + " has bars for leaks alone: give --leaks, too");
  bench::check_bar_names(bars, contender_names(context, given.peers), file);
  if (has_ratios) check_ratios(bars, file, targets, context.device());
  return bars;
}

void prepare_outputs(const BenchArguments& given) {
  for (const std::string& file : {given.json, given.csv}) {
    if (!file.empty()) check_writable(file);
  }
  const auto place = [](const std::string& file) { return fs::absolute(file).lexically_normal(); };
  const bool same = !given.json.empty() && !given.csv.empty() && place(given.json) == place(given.csv);
  if (same) throw InputError("--csv", "the same file as --json");
  if (given.plot.empty()) return;
  check_plotting();
  std::error_code error;
  fs::create_directory(given.plot, error);
  if (!fs::is_directory(given.plot)) throw InputError("--plot", fmt::format("'{}' is not a folder", given.plot));
  check_writable(fs::path(given.plot) / "bench.json");
}

void write_outputs(const BenchArguments& given, const bench::Report& report) {
  if (!given.json.empty()) write_file_atomically(given.json, bench::report_json(report));
  if (!given.csv.empty()) write_file_atomically(given.csv, bench::report_csv(report));
  if (given.plot.empty()) return;
  const fs::path json = fs::path(given.plot) / "bench.json";
  write_file_atomically(json, bench::report_json(report));
  if (!report.interrupted) plot_results(json, given.plot);
}

int run_bench_command(const BenchArguments& given) {
  BenchPlan plan;
  plan.targets = choose_targets(given);
  if (given.peers) peer_name();
  plan.peers = given.peers;
  plan.quick = given.quick;
  plan.leaks = given.leaks;
  plan.engines = given.scenes.empty();
  plan.effort.rounds = given.rounds > 0 ? given.rounds : given.quick ? kQuickRounds : kRounds;
  if (given.quick && given.rounds == 0) plan.effort.enough_ms = kQuickMs;
  plan.resolution = given.resolution;
  plan.tracers = given.tracers;
  plan.leak_rays = given.leak_rays;
  if (plan.resolution % 32 != 0) throw InputError("--resolution", "not a multiple of 32");
  if (plan.leak_rays % 64 != 0) throw InputError("--leak-rays", "not a multiple of 64");
  Context context(choose_single_device(given.device, "bench measures"));
  if (given.judged) plan.bars = load_bars(context, given, plan.targets);
  check_tracers(context, plan);
  prepare_outputs(given);

  const InterruptGuard interrupt;
  BenchOutput output;
  output.show = [](const std::string& table) {
    std::fputs(table.c_str(), stdout);
    std::fflush(stdout);  // main() tells what went wrong
  };
  output.should_stop = [&interrupt] { return interrupt.interrupted(); };
  const bench::Report report = run_bench(context, plan, output);
  write_outputs(given, report);
  if (report.interrupted) {
    fmt::print(stderr, "hemiray: interrupted; what was complete is in the tables{}\n",
               given.json.empty() && given.csv.empty() && given.plot.empty() ? "" : " and files");
    return static_cast<int>(ExitCode::interrupted);
  }
  const bool reached = std::all_of(report.bars.begin(), report.bars.end(),
                                   [](const bench::BarResult& bar) { return bar.verdict == bench::Verdict::pass; });
  return static_cast<int>(reached ? ExitCode::ok : ExitCode::verdict);
}

}  // namespace

void add_bench_command(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand("bench", "Measure tree builds and ray rates, alone or beside Embree");
  const auto given = std::make_shared<BenchArguments>();
  command->add_option("SCENE", given->scenes, "interior, terrain, hair, instances, or a scene file");
  command->add_flag("--quick", given->quick, "Under five minutes: the room of the bars at 250k and 1M triangles");
  command->add_flag("--peers", given->peers,
                    "Trace the same rays through Embree, too (where built with libembree-dev)");
  CLI::Option* bars =
      command->add_option("--bars", given->bars, "Hold the ratios to this file (default: bench/bars.json)")
          ->expected(0, 1)
          ->type_name("[FILE]");
  CLI::Option* leaks =
      command->add_flag("--leaks", given->leaks, "Count rays that leak through edges and vertices of closed meshes");
  command->add_option("--json", given->json, "Write all figures as JSON")->type_name("FILE");
  command->add_option("--csv", given->csv, "Write all figures as a table")->type_name("FILE");
  command->add_option("--plot", given->plot, "Draw PNG and SVG into this folder (python3-matplotlib)")
      ->type_name("FOLDER");
  command->add_option("--rounds", given->rounds, "Timed rounds (default: 11, with --quick up to 7)")
      ->check(CLI::Range(1, 1000));
  command
      ->add_option("--triangles", given->triangles,
                   "Sizes of the procedural scenes, 10k to 20M, comma separated (default: 10k to 10M)")
      ->delimiter(',')
      ->allow_extra_args(false);
  command->add_option("--resolution", given->resolution, "Primary rays on a side, a multiple of 32")
      ->check(CLI::Range(32, 4096))
      ->capture_default_str();
  command->add_option("--leak-rays", given->leak_rays, "Rays of --leaks a mesh and target, a multiple of 64")
      ->needs(leaks)
      ->check(CLI::Range(64, 1 << 26))
      ->capture_default_str();
  command
      ->add_option(
          "--tracers", given->tracers,
          "Only those with this in their names, such as quality/watertight (large scenes: each tree takes memory)")
      ->type_name("TEXT");
  command->add_option("--device", given->device, "Index, part of a name, cpu or gpu (default: HEMIRAY_DEVICE)");
  command->footer(kExamples);
  command->callback([given, bars, &exit_code] {
    given->judged = bars->count() > 0;
    exit_code = run_bench_command(*given);
  });
}

}  // namespace hemiray::app
