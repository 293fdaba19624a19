// `hemiray stability`: hard cases on ladders of severity, judged by an exact oracle, beside Embree where it is there.
#include <cstdio>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <ctime>
#include <memory>
#include <thread>

#include "host/app/bench_contenders.hpp"
#include "host/app/commands.hpp"
#include "host/base/atomic_file.hpp"
#include "host/base/build_info.hpp"
#include "host/base/clock.hpp"
#include "host/base/error.hpp"
#include "host/base/interrupt.hpp"
#include "host/base/progress.hpp"
#include "host/base/read_file.hpp"
#include "host/base/spelling.hpp"
#include "host/bench/processor.hpp"
#include "host/stability/compare_runs.hpp"
#include "host/stability/report.hpp"

namespace hemiray::app {
namespace {

constexpr const char* kExamples = R"(Examples:
  hemiray stability                                   all cases, a million rays a rung
  hemiray stability --rays 10000 --cases scale,gap    some, quickly
  hemiray stability --peers --json s.json --markdown docs/STABILITY.md
  hemiray stability --device Intel --json intel.json; hemiray stability --device pocl --compare intel.json
  hemiray stability --cases gap --json gap.json && python3 bench/plot.py gap.json docs/images

Each case is a ladder of rungs. Rays are aimed at edges, vertices and planes of boxes; an exact oracle judges every
answer. --cases takes parts of names, such as 'leaving'. With --compare every rung on which the run differs from another
device's is named, by verdict, rates or a hash of all answers. Exit code: 0 every rung holds, 3 one does not.)";

constexpr std::uint64_t kMaxRunBytes = std::uint64_t{64} << 20U;  // of a file to compare with

struct StabilityArguments {
  std::string json, markdown, device;
  std::vector<std::string> cases;  // empty: all
  std::uint32_t rays = 1'000'000;
  std::uint32_t seed = 5;
  bool peers = false;
  std::string precision = "single";
  std::vector<std::string> compare;
  bool strict = false;
};

// Those with one of the words in their names.
std::vector<stability::Case> choose_cases(const std::vector<std::string>& wanted) {
  std::vector<stability::Case> cases = stability::all_cases();
  if (wanted.empty()) return cases;
  std::vector<std::string_view> names;
  for (const stability::Case& one : cases) names.push_back(one.name);
  const auto has = [](const std::string& name, const std::string& word) {
    return name.find(word) != std::string::npos;
  };
  for (const std::string& word : wanted) {
    if (word.empty()) throw InputError("--cases", "is empty; name cases, or leave it out for all");
    if (std::none_of(cases.begin(), cases.end(), [&](const auto& one) { return has(one.name, word); })) {
      throw InputError("--cases", fmt::format("{} is in no name of {}", in_quotes(word), fmt::join(names, ", ")) +
                                      spelling_hint(word, names));
    }
  }
  std::erase_if(cases, [&](const stability::Case& one) {
    return std::none_of(wanted.begin(), wanted.end(), [&](const auto& word) { return has(one.name, word); });
  });
  return cases;
}

std::string command_line(const StabilityArguments& given) {
  std::string text = "hemiray stability";
  if (given.peers) text += " --peers";
  if (!given.cases.empty()) text += fmt::format(" --cases \"{}\"", fmt::join(given.cases, ","));
  text += fmt::format(" --rays {}", given.rays);
  if (given.seed != StabilityArguments{}.seed) text += fmt::format(" --seed {}", given.seed);
  if (given.precision != "single") text += " --precision " + given.precision;
  if (given.strict) text += " --strict";
  if (!given.compare.empty()) text += " --compare OTHER.json";
  return text + " --markdown " + given.markdown;
}

std::string today() {
  const std::time_t now = std::time(nullptr);
  std::tm utc{};
  gmtime_r(&now, &utc);
  std::array<char, 16> text{};
  std::strftime(text.data(), text.size(), "%Y-%m-%d", &utc);
  return text.data();
}

stability::Report describe(const Context& context, const StabilityArguments& given, unsigned threads) {
  stability::Report report;
  report.machine.device = context.device().name;
  report.machine.platform = context.device().platform;
  report.machine.driver = context.device().driver;
  report.machine.processor = bench::this_processor().name;
  report.machine.threads = threads;
  report.machine.version = kVersion;
  report.machine.commit = kCommit;
  if (given.peers) report.machine.peer = peer_name();
  report.command = command_line(given);
  report.date = today();
  report.rays = given.rays;
  report.seed = given.seed;
  report.precision = given.precision;
  report.strict = given.strict;
  report.complete = given.cases.empty() && given.precision == "single";
  return report;
}

std::vector<stability::OtherRun> read_others(const std::vector<std::string>& files, const stability::Report& report,
                                             const std::vector<stability::Case>& cases) {
  std::vector<stability::OtherRun> others;
  for (const std::string& file : files) {
    const std::vector<std::uint8_t> bytes = read_file(file, kMaxRunBytes);
    others.push_back(stability::read_run({bytes.begin(), bytes.end()}, file, report));
    const std::vector<stability::OtherRung>& rungs = others.back().rungs;
    const auto is_chosen = [&cases](const stability::OtherRung& rung) {
      return std::any_of(cases.begin(), cases.end(), [&](const auto& one) { return one.name == rung.case_name; });
    };
    if (std::none_of(rungs.begin(), rungs.end(), is_chosen)) throw InputError(file, "has none of the cases of --cases");
  }
  return others;
}

void show(const std::string& text) {
  std::fputs(text.c_str(), stdout);
  std::fflush(stdout);  // main() tells what went wrong
}

int run_stability(const StabilityArguments& given) {
  const std::vector<stability::Case> cases = choose_cases(given.cases);
  if (given.peers) peer_name();
  for (const std::string& file : {given.json, given.markdown}) {
    if (!file.empty()) check_writable(file);
  }
  Context context(choose_device(given.device));
  const unsigned threads = std::max(1U, std::thread::hardware_concurrency());
  const auto peer = given.peers ? make_robust_peer(threads) : nullptr;
  stability::Report report = describe(context, given, threads);
  const std::vector<stability::OtherRun> others = read_others(given.compare, report, cases);
  stability::LadderOptions options;
  options.rays = given.rays;
  options.seed = given.seed;
  options.peer = peer.get();
  options.threads = threads;
  options.double_precision = given.precision == "double";
  options.strict = given.strict;
  stability::Ladder ladder(context, options);

  const InterruptGuard interrupt;
  Progress progress("stability", true);
  const double start = steady_ms();
  std::size_t rungs = 0, done = 0;
  for (const stability::Case& one : cases) rungs += one.rungs.size();
  show(stability::report_head(report));
  for (const stability::Case& one : cases) {
    stability::CaseResults results{one.name, one.what, {}};
    for (const auto& make : one.rungs) {
      if (interrupt.interrupted()) break;
      if (auto result = ladder.run(one.name, make())) results.rungs.push_back(std::move(*result));
      progress.update(static_cast<double>(++done) / static_cast<double>(rungs), 0.0);
    }
    progress.clear();
    if (results.rungs.empty()) continue;
    show(stability::case_table(results));
    report.cases.push_back(std::move(results));
  }
  progress.finish();
  report.seconds = (steady_ms() - start) / 1000.0;
  const bool interrupted = done < rungs;
  if (report.cases.empty() && !interrupted) {
    throw InputError("--cases", "rays that leave surfaces are not asked in double precision; take --precision single");
  }
  if (interrupted) report.complete = false;
  for (const stability::OtherRun& other : others) {
    report.comparisons.push_back(stability::compare_runs(report, other));
    show(stability::comparison_text(report.comparisons.back()));
  }
  if (!given.json.empty()) write_file_atomically(given.json, stability::report_json(report));
  if (!given.markdown.empty()) write_file_atomically(given.markdown, stability::report_markdown(report));
  if (interrupted) {
    fmt::print(stderr, "hemiray: interrupted; what was complete has been told\n");
    return static_cast<int>(ExitCode::interrupted);
  }
  return static_cast<int>(stability::holds(report) ? ExitCode::ok : ExitCode::verdict);
}

}  // namespace

void add_stability_command(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand("stability", "Measure how hard cases break, judged by an exact oracle");
  const auto given = std::make_shared<StabilityArguments>();
  command->add_option("--json", given->json, "Write all rates as JSON")->type_name("FILE");
  command->add_option("--markdown", given->markdown, "Write the report as Markdown")->type_name("FILE");
  command->add_option("--rays", given->rays, "Rays a rung")->check(CLI::Range(64, 1 << 26))->capture_default_str();
  command->add_option("--seed", given->seed, "Of the rays")->capture_default_str();
  command->add_option("--cases", given->cases, "Parts of names of cases, comma separated (default: all)")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->type_name("NAME");
  command->add_flag("--peers", given->peers, "Judge Embree by the same rays (where built with libembree-dev)");
  command
      ->add_option("--precision", given->precision,
                   "double asks the same rays in double precision; rays that leave surfaces are left out")
      ->check(CLI::IsMember({"single", "double"}))
      ->capture_default_str();
  command->add_flag("--strict", given->strict, "Compile strict: answers are to be the same bits on every device");
  command
      ->add_option("--compare", given->compare,
                   "Name the rungs that differ from those of runs elsewhere, written with --json; comma separated")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->type_name("FILE");
  command->add_option("--device", given->device, "Index, part of a name, cpu or gpu (default: HEMIRAY_DEVICE)");
  command->footer(kExamples);
  command->callback([given, &exit_code] { exit_code = run_stability(*given); });
}

}  // namespace hemiray::app
