// How radiosity grows: time and memory of form factors and of the solution to 1e-4, from a thousand patches to 64
// thousand, memory predicted beside memory used, and the exponents. The solution's time is told without that of its
// kernels' compilation, which is told beside it, as the process's first solution takes it. What is solved is certified
// by the bound printed, relative to the largest radiosity. Usage: factor_growth SCENE [--patches N,...] [--form-factors
// hemicube,raster,hybrid]
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "bench/program.hpp"
#include "host/base/atomic_file.hpp"
#include "host/base/build_info.hpp"
#include "host/base/error.hpp"
#include "host/base/numbers.hpp"
#include "host/radiosity/factor_memory.hpp"
#include "host/radiosity/radiosity.hpp"
#include "host/scene/load.hpp"

namespace hemiray {
namespace {

using Json = nlohmann::ordered_json;

struct Row {
  std::string method;
  std::uint32_t patches = 0;
  RadiosityStatistics facts;
  std::uint64_t iterations = 0, judged = 0;
  double bound = 0.0;  ///< of the error, relative to the largest radiosity
  bool converged = false;
  std::string stages;

  [[nodiscard]] double solve_ms() const { return facts.solve_ms - facts.solve_compile_ms; }
};

RadiosityOptions options_for(const std::string& method, std::uint32_t patches) {
  RadiosityOptions options;
  options.mesh.patches = patches;
  options.residual_samples = 0;
  options.factors.method = method == "hybrid" ? FormFactors::hybrid : FormFactors::hemicube;
  options.factors.hemicube.view = method == "raster" ? CubeView::raster : CubeView::rays;
  if (method == "hybrid") options.factors.hemicube.resolution = kReachResolution;
  return options;
}

// The kernels that took most of the device's time between two moments, of either method.
std::string longest(const std::vector<StageTime>& before, std::vector<StageTime> after) {
  constexpr std::size_t kShown = 4;
  for (StageTime& stage : after) {
    for (const StageTime& earlier : before) {
      if (earlier.name == stage.name) stage.milliseconds -= earlier.milliseconds;
    }
  }
  std::sort(after.begin(), after.end(),
            [](const StageTime& a, const StageTime& b) { return a.milliseconds > b.milliseconds; });
  std::string text;
  for (std::size_t i = 0; i < std::min(kShown, after.size()); i++) {
    text += fmt::format("{}{} {:.2f} s", i > 0 ? ", " : "", after[i].name, 1e-3 * after[i].milliseconds);
  }
  return text;
}

Row measure(Context& context, const FlatScene& flat, const std::string& method, std::uint32_t patches) {
  context.restart_peak();
  const std::vector<StageTime> before = context.profiler().stages();
  const Radiosity r = compute_radiosity(context, flat, options_for(method, patches));
  context.finish();  // the profiler has the solution's kernels, too
  return {method,
          r.mesh.patch_count(),
          r.statistics,
          r.solution.history.back().iteration,
          r.solution.history.size(),
          r.solution.history.back().bound / r.solution.largest,
          r.solution.converged,
          longest(before, context.profiler().stages())};
}

// The slope of the least squares line through (log patches, log value); NaN for fewer than two rows.
double exponent(const std::vector<Row>& rows, double (*value)(const Row&)) {
  double n = 0, x = 0, y = 0, xx = 0, xy = 0;
  for (const Row& row : rows) {
    const double u = std::log(row.patches), v = std::log(value(row));
    n++, x += u, y += v, xx += u * u, xy += u * v;
  }
  return n < 2 ? std::numeric_limits<double>::quiet_NaN() : (n * xy - x * y) / (n * xx - x * x);
}

void print(const Row& row) {
  const RadiosityStatistics& s = row.facts;
  const double seconds = 1e-3 * s.factors_ms;
  fmt::print("{:<9}{:>8}{:>8}{:>12}{:>12}{:>12}{:>12}{:>10.2f} s{:>18}{:>15}{:>10.3f} s{:>5}{:>9.1e}{}\n", row.method,
             row.patches, s.rows, format_count(s.entries), format_bytes(s.factor_bytes_at_most),
             format_bytes(s.factor_bytes), format_bytes(s.peak_bytes), seconds,
             format_rate(static_cast<double>(s.entries) / seconds, "factors/s"),
             format_rate(static_cast<double>(s.rays) / seconds, "rays/s"), 1e-3 * row.solve_ms(), row.iterations,
             row.bound, row.converged ? "" : "  not converged");
  fmt::print("           longest kernels: {}\n", row.stages);
  std::fflush(stdout);
}

void print_exponents(const std::vector<Row>& rows) {
  fmt::print(
      "{:<9}time ~ patches^{:.2f}, factors ~ patches^{:.2f}, memory ~ patches^{:.2f}, solution ~ patches^{:.2f}\n",
      rows.front().method, exponent(rows, [](const Row& r) { return r.facts.factors_ms; }),
      exponent(rows, [](const Row& r) { return static_cast<double>(r.facts.entries); }),
      exponent(rows, [](const Row& r) { return static_cast<double>(r.facts.factor_bytes); }),
      exponent(rows, [](const Row& r) { return r.solve_ms(); }));
}

Json to_json(const Row& row) {
  const RadiosityStatistics& s = row.facts;
  return {{"method", row.method},
          {"patches", row.patches},
          {"rows", s.rows},
          {"entries", s.entries},
          {"rays", s.rays},
          {"factor_bytes_predicted", s.factor_bytes_at_most},
          {"factor_bytes", s.factor_bytes},
          {"peak_bytes", s.peak_bytes},
          {"factors_ms", s.factors_ms},
          {"solve_ms", row.solve_ms()},
          {"solve_compile_ms", s.solve_compile_ms},
          {"iterations", row.iterations},
          {"iterations_judged", row.judged},
          {"bound", row.bound},
          {"converged", row.converged}};
}

// Bytes of factors pair by pair, at most; compute_radiosity() takes hemicubes instead where they are not there.
std::uint64_t pair_bytes(std::uint64_t patches) { return patches * patches * entry_bytes(FactorPrecision::single); }

void run(const std::string& scene, const std::vector<std::string>& methods, const std::vector<std::uint32_t>& sizes,
         const std::string& json, const std::string& device) {
  if (!json.empty()) check_writable(json);
  const FlatScene flat = flatten_scene(load_scene(scene));
  Context context(choose_device(device));
  fmt::print("{}, {} compute units, commit {}; {}\n", context.device().name, context.device().compute_units, kCommit,
             scene);
  fmt::print("{:<9}{:>8}{:>8}{:>12}{:>12}{:>12}{:>12}{:>12}{:>18}{:>15}{:>12}{:>5}{:>9}\n", "method", "patches", "rows",
             "factors", "at most", "used", "peak", "time", "", "", "solution", "its", "bound");
  Json report = {{"device", context.device().name}, {"commit", kCommit}, {"scene", scene}, {"factors", Json::array()}};
  for (const std::string& method : methods) {
    std::vector<Row> rows;
    const Row first = measure(context, flat, method, 300);  // compiles the kernels
    fmt::print("{:<9}kernels of the first solution: {:.3f} s to compile, or to load\n", method,
               1e-3 * first.facts.solve_compile_ms);
    report["first_solve_compile_ms"][method] = first.facts.solve_compile_ms;
    for (const std::uint32_t patches : sizes) {
      const std::uint64_t limit = factor_memory_limit(context);
      if (method == "hybrid" && pair_bytes(patches) > limit) {
        fmt::print("{:<9}{:>8}  left out: pair by pair it may take {}, and {} are allowed\n", method, patches,
                   format_bytes(pair_bytes(patches)), format_bytes(limit));
        continue;
      }
      rows.push_back(measure(context, flat, method, patches));
      print(rows.back());
      report["factors"].push_back(to_json(rows.back()));
    }
    if (rows.size() > 1) print_exponents(rows);
  }
  if (!json.empty()) write_file_atomically(json, report.dump(2) + "\n");
}

}  // namespace
}  // namespace hemiray

int main(int argc, char** argv) {
  CLI::App app("How radiosity's time and memory grow with patches");
  std::string scene, json, device;
  std::vector<std::string> methods = {"hemicube", "hybrid"};
  std::vector<std::uint32_t> sizes = {1000, 4000, 16000, 64000};
  app.add_option("SCENE", scene, "Such as bench/occluded_room.json")->required();
  app.add_option("--form-factors", methods, "Methods, comma separated")
      ->delimiter(',')
      ->check(CLI::IsMember({"hemicube", "raster", "hybrid"}));
  app.add_option("--patches", sizes, "Patches, at most, comma separated")
      ->delimiter(',')
      ->check(CLI::Range(100, 1000000));
  app.add_option("--json", json, "Write all figures as JSON, for bench/plot.py")->type_name("FILE");
  app.add_option("--device", device, "Index, part of a name, cpu or gpu");
  return hemiray::bench::run_program(app, argc, argv, [&] { hemiray::run(scene, methods, sizes, json, device); });
}
