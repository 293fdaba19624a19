// `hemiray view-factors SCENE -o FILE`: factors between the scene's named areas.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <utility>

#include <nlohmann/json.hpp>

#include "host/app/commands.hpp"
#include "host/app/factor_report.hpp"
#include "host/app/radiosity_arguments.hpp"
#include "host/base/atomic_file.hpp"
#include "host/base/clock.hpp"
#include "host/base/error.hpp"
#include "host/base/interrupt.hpp"
#include "host/base/progress.hpp"
#include "host/radiosity/form_factors.hpp"
#include "host/radiosity/view_factors.hpp"
#include "host/scene/load.hpp"

namespace hemiray::app {
namespace {

constexpr const char* kExamples = R"(Examples:
  hemiray view-factors parts.obj -o F.csv                      one line a pair: from, to, area, factor, errors
  hemiray view-factors parts.obj -o F.npy --patches 20000      n x n, for NumPy
  hemiray view-factors parts.obj -o F.vf --view3d-input parts.vs3      View3D's output file, and its input to compare

Areas are the file's objects ('g' and 'o' of OBJ), by name. Fronts (counter-clockwise) send and take light, backs only
stop it. Each factor comes with its error, split: geometry (a bound of the quadrature's error; what flat patches of
round bodies cost is not in it), sampling (a standard error of the rays of partly hidden pairs) and visibility (with
--pair-search rays: what pairs taken for seen or hidden wrongly may cost); --form-factors hemicube and raster know none.
In --json these are factor_errors, n x n each; row_errors are means over the patches' rows: geometry, sampling, closure
(how far rows of closed scenes were from 1) and the share that may be partly_hidden. Interrupt (Ctrl-C) writes nothing:
every factor between areas is a sum over all rows.)";

// Factors are asked for alone where they must be trusted.
RadiosityArguments with_all_pairs_found() {
  RadiosityArguments arguments;
  arguments.pair_search = "shafts";
  return arguments;
}

struct FactorArguments {
  std::string scene, output, view3d_input, device;
  bool quiet = false, json = false;
  RadiosityArguments radiosity = with_all_pairs_found();
};

std::string or_unnamed(const std::string& name, const char* kind, std::size_t index) {
  return name.empty() ? fmt::format("{} {}", kind, index) : name;
}

// In the order in which flat scenes number objects.
std::vector<std::string> object_names(const Scene& scene) {
  std::vector<std::string> names;
  const auto add = [&names](const auto& things, const char* kind) {
    for (std::size_t i = 0; i < things.size(); i++) names.push_back(or_unnamed(things[i].name, kind, i));
  };
  add(scene.objects, "object");
  add(scene.spheres, "sphere");
  add(scene.shapes, "shape");
  add(scene.planes, "plane");
  for (const Light& light : scene.lights) {
    if (light.kind == LightKind::area && light.visible) names.push_back(or_unnamed(light.name, "light", names.size()));
  }
  return names;
}

void check_outputs(const FactorArguments& given) {
  const auto ends = [&](const char* end) { return given.output.ends_with(end); };
  if (!ends(".csv") && !ends(".npy") && !ends(".vf")) {
    throw InputError("--output", fmt::format("'{}' ends in none of .csv, .npy and .vf (View3D)", given.output));
  }
  check_writable(given.output);
  if (given.view3d_input.empty()) return;
  check_writable(given.view3d_input);
  if (is_same_file(given.view3d_input, given.output)) {
    throw InputError("--view3d-input", fmt::format("'{}' is for the factors, too; name another file", given.output));
  }
}

// The parts of an error, by name.
constexpr std::pair<const char*, double ErrorSplit::*> kErrorParts[] = {
    {"geometry", &ErrorSplit::geometry}, {"sampling", &ErrorSplit::sampling}, {"visibility", &ErrorSplit::visibility}};

// n x n values as an array of rows.
template <typename Value>
nlohmann::ordered_json rows_of(std::size_t n, const Value& value) {
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < n; i++) {
    std::vector<double> row;
    for (std::size_t j = 0; j < n; j++) row.push_back(value(i * n + j));
    rows.push_back(row);
  }
  return rows;
}

std::string as_json(const ViewFactors& f, const PatchMesh& mesh, const FactorReport& report, double seconds) {
  nlohmann::ordered_json json;
  json["patches"] = mesh.patch_count();
  json["rays"] = report.cube_rays + report.pair_rays + report.sample_rays;
  if (report.enforcement) json["row_errors"] = row_errors_json(report.row_errors);
  json["seconds"] = seconds;
  json["names"] = f.names;
  json["areas_m2"] = f.areas_m2;
  json["row_sums"] = f.row_sums;
  const std::size_t n = f.names.size();
  json["factors"] = rows_of(n, [&](std::size_t k) { return f.factors[k]; });
  if (!f.errors.empty()) {
    for (const auto& [name, part] : kErrorParts) {
      json["factor_errors"][name] = rows_of(n, [&, part = part](std::size_t k) { return f.errors[k].*part; });
    }
  }
  json["reciprocity_errors"] = rows_of(n, [&](std::size_t k) { return f.reciprocity_errors[k]; });
  return json.dump(2) + "\n";
}

std::string as_table(const ViewFactors& f, const PatchMesh& mesh, double seconds) {
  constexpr std::size_t kMostColumns = 8;
  const std::size_t n = f.names.size();
  std::string text = fmt::format("{} areas, {} patches, {:.2f} s\n", n, mesh.patch_count(), seconds);
  if (n > kMostColumns) return text;
  text += fmt::format("{:<16} {:>10}", "from", "area m2");
  for (const std::string& name : f.names) text += fmt::format(" {:>11.11}", name);
  text += fmt::format(" {:>11}\n", "sum");
  for (std::size_t i = 0; i < n; i++) {
    text += fmt::format("{:<16.16} {:>10.4g}", f.names[i], f.areas_m2[i]);
    for (std::size_t j = 0; j < n; j++) text += fmt::format(" {:>11.7f}", f.factors[i * n + j]);
    text += fmt::format(" {:>11.7f}\n", f.row_sums[i]);
    if (f.errors.empty()) continue;
    for (const auto& [name, part] : kErrorParts) {
      text += fmt::format("{:>27}", fmt::format("+- {}", name));
      for (std::size_t j = 0; j < n; j++) text += fmt::format(" {:>11.1e}", f.errors[i * n + j].*part);
      text += '\n';
    }
  }
  return text;
}

int run_view_factors(const FactorArguments& given) {
  const RadiosityOptions options = to_radiosity_options(given.radiosity);
  check_outputs(given);
  const Scene scene = load_scene(given.scene);
  const PatchMesh mesh = make_patch_mesh(flatten_scene(scene), options.mesh);
  const FactorGroups groups = groups_by_name(mesh, object_names(scene));
  Context context(choose_device(given.device, "--device"));
  const InterruptGuard interrupt;
  Progress progress("view factors", !given.quiet);
  Parallel parallel(context);
  AccelBuilder builder(context, parallel);
  const double start = steady_ms();
  Hemicubes hemicubes(context, parallel, builder, mesh, options.factors.hemicube);
  std::vector<std::uint32_t> fronts;
  for (std::uint32_t i = 0; i < mesh.patch_count(); i++) fronts.push_back(2 * i);
  FactorReport report;
  const FactorMatrix matrix = make_form_factors_of(
      context, parallel, mesh, hemicubes, fronts, options.factors, report,
      [&](double fraction) {
        progress.update(fraction, 0.0);
        return !interrupt.interrupted();
      },
      &groups);
  progress.finish();
  if (interrupt.interrupted()) {
    fmt::print(stderr,
               "hemiray: interrupted: no factor between areas was computed whole, each is a sum over all rows; nothing "
               "is written\n");
    return static_cast<int>(ExitCode::interrupted);
  }
  const ViewFactors factors = view_factors(mesh, groups, read_rows(matrix), report.exchange_errors);
  const auto is_zero = [](double factor) { return factor == 0.0; };
  if (!given.quiet && std::all_of(factors.factors.begin(), factors.factors.end(), is_zero)) {
    fmt::print(stderr,
               "hemiray: no area sees another; a triangle's front is where its corners run counter-clockwise\n");
  }
  const double seconds = 1e-3 * (steady_ms() - start);
  const bool closed = std::all_of(factors.row_sums.begin(), factors.row_sums.end(),
                                  [](double sum) { return std::abs(sum - 1.0) < 1e-3; });
  write_file_atomically(given.output, given.output.ends_with(".csv") ? factors_as_csv(factors)
                                      : given.output.ends_with(".npy")
                                          ? factors_as_npy(factors)
                                          : factors_as_view3d(factors, group_emittances(mesh, groups), closed));
  if (!given.view3d_input.empty())
    write_file_atomically(given.view3d_input, patches_as_view3d(mesh, groups, given.scene));
  if (given.json) {
    std::fputs(as_json(factors, mesh, report, seconds).c_str(), stdout);
  } else if (!given.quiet) {
    std::fputs(as_table(factors, mesh, seconds).c_str(), stdout);
  }
  return static_cast<int>(ExitCode::ok);
}

}  // namespace

void add_view_factors_command(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand("view-factors", "Factors between named areas, for light and heat");
  const auto given = std::make_shared<FactorArguments>();
  command->add_option("SCENE", given->scene, "Scene: .json, .gltf, .glb, .obj or .ply")->required()->type_name("FILE");
  command->add_option("-o,--output", given->output, "Factors to write: .csv, .npy or .vf")
      ->required()
      ->type_name("FILE");
  command->add_option("--view3d-input", given->view3d_input, "Write the patches as an input file for View3D, too");
  command->add_option("--device", given->device, "Index, part of a name, cpu or gpu (default: HEMIRAY_DEVICE)");
  command->add_option("--seed", given->radiosity.seed, "Seed of the random numbers")->capture_default_str();
  command->add_flag("--quiet", given->quiet, "Print nothing but errors");
  command->add_flag("--json", given->json, "Print the factors as JSON on stdout");
  add_mesh_options(*command, given->radiosity);
  command->footer(kExamples);
  command->callback([given, &exit_code] { exit_code = run_view_factors(*given); });
}

}  // namespace hemiray::app
