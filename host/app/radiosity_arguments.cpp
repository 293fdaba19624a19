#include "host/app/radiosity_arguments.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <system_error>

#include "host/app/factor_report.hpp"
#include "host/app/refine_report.hpp"
#include "host/base/atomic_file.hpp"
#include "host/base/error.hpp"
#include "host/base/numbers.hpp"
#include "host/base/spelling.hpp"

namespace hemiray::app {
namespace {

constexpr std::uint32_t kMostResidualSamples = 1U << 24U;
constexpr std::uint32_t kMostGatherRays = 65536;
constexpr double kMebibyte = 1 << 20;

std::uint32_t divisions_of(std::uint32_t points) {
  for (std::uint32_t d = 1; d <= 16; d++) {
    if (d * d == points) return d;
  }
  throw InputError("--points", fmt::format("{} points a patch cannot be had; take a square from 1 to 256", points));
}

CLI::Option* add_to_group(RadiosityArguments& a, CLI::Option* option) {
  a.given.push_back(option);
  return option->group("Radiosity");
}

bool is_by_cubes(const RadiosityArguments& a) { return a.form_factors == "hemicube" || a.form_factors == "raster"; }

bool is_given(const RadiosityArguments& a, const char* name) {
  return std::ranges::any_of(
      a.given, [name](const CLI::Option* option) { return option->get_name() == name && option->count() > 0; });
}

// An option without effect is a mistake: who gives it expects one.
void check_effective(const RadiosityArguments& a) {
  const auto refuse = [&a](const char* name, bool effective, const std::string& why) {
    if (is_given(a, name) && !effective) throw InputError(name, why + "; leave it out");
  };
  const bool may_shoot = a.solver == "southwell" || a.solver == "auto";
  refuse("--save-every", !a.save.empty() || !a.resume.empty(),
         "is for a file of --save or --resume, and none is named");
  refuse("--shots", may_shoot, "is for --solver southwell, not " + a.solver);
  refuse("--pick", may_shoot, "is for --solver southwell, not " + a.solver);
  if (a.solver == "cg" && is_by_cubes(a)) {
    throw InputError("--solver", "cg needs symmetric form factors, which --form-factors " + a.form_factors +
                                     " does not give; take gmres, or --form-factors hybrid");
  }
  refuse("--pair-search", !is_by_cubes(a), "is for form factors pair by pair, not --form-factors " + a.form_factors);
  refuse("--pair-rays", !is_by_cubes(a), "is for form factors pair by pair, not --form-factors " + a.form_factors);
  refuse("--patches", a.edge == 0.0, "does not go with --edge, which says how fine the mesh is");
  refuse("--crease", a.display == "smooth", "is for --display smooth, not " + a.display);
}

KeepOptions to_keep_options(const RadiosityArguments& a, const std::vector<std::string>& others) {
  if (!a.save.empty() && !a.resume.empty()) {
    throw InputError("--save", "does not go with --resume, which keeps in its own file; leave one of the two out");
  }
  const char* option = a.save.empty() ? "--resume" : "--save";
  const KeepOptions keep{a.save.empty() ? a.resume : a.save, a.save.empty(), a.keep_every};
  if (keep.file.empty()) return keep;
  std::error_code error;
  const bool there = std::filesystem::exists(keep.file, error);
  if (!there && keep.resume) {
    throw InputError(option, fmt::format("there is no file '{}'; --save {} begins one", keep.file, keep.file));
  }
  if (there && !keep.resume) {
    throw InputError(option, fmt::format("'{}' is there already; go on from it with --resume {}, or remove it",
                                         keep.file, keep.file));
  }
  for (const std::string& other : others) {
    if (!other.empty() && is_same_file(other, keep.file)) {
      throw InputError(option, fmt::format("'{}' is for something else, too; name another file", keep.file));
    }
  }
  check_writable(keep.file);
  return keep;
}

}  // namespace

void add_mesh_options(CLI::App& command, RadiosityArguments& a) {
  const auto add = [&a](CLI::Option* option) { return add_to_group(a, option); };
  add(command.add_option("--patches", a.patches, "Patches, at most; round bodies take what --chord asks for"))
      ->capture_default_str();
  add(command.add_option("--edge", a.edge, "Longest edge of a patch [m], in place of --patches"));
  add(command.add_option(
      "--chord", a.chord,
      "Largest distance of a tessellated round surface from the true one [m] (default: 1 % of its radius)"));
  add(command.add_option(
          "--form-factors", a.form_factors,
          "By hemicubes alone (rays through their cells, or patches drawn on their faces), pair by pair, "
          "or both: checked against each other, closed rows made to sum to one"))
      ->check(CLI::IsMember({"hemicube", "raster", "analytic", "hybrid"}))
      ->capture_default_str();
  add(command.add_option("--pair-rays", a.pair_rays, "Rays between partly hidden pairs, at most; 16 to find which are"))
      ->check(CLI::Range(4, 65536))
      ->capture_default_str();
  add(command.add_option("--pair-search", a.pair_search,
                         "How partly hidden pairs are found: by rays between patches' middles, which miss some at "
                         "shadows' edges, or by what reaches into each pair's shaft, which misses none and takes far "
                         "longer; each then gets rays until ten times more accurate"))
      ->check(CLI::IsMember({"rays", "shafts"}))
      ->capture_default_str();
  add(command.add_option("--resolution", a.resolution,
                         "Cells along an edge of a hemicube, even, 8 to 1024 (default: 64; 16 where hemicubes only "
                         "say which patches light reaches)"));
  add(command.add_option("--points", a.points, "Hemicubes a patch: a square from 1 to 256"))->capture_default_str();
  add(command.add_option("--cells", a.cells,
                         "Rays go through the cells' middles, of cubes that are turned each its own "
                         "way, or through random points of them"))
      ->check(CLI::IsMember({"aligned", "turned", "jittered"}))
      ->capture_default_str();
}

void add_radiosity_options(CLI::App& command, RadiosityArguments& a) {
  add_mesh_options(command, a);
  const auto add = [&a](CLI::Option* option) { return add_to_group(a, option); };
  add(command.add_option("--solver", a.solver,
                         "How the system is solved; auto: cg where form factors are symmetric, else gmres, and "
                         "southwell where they do not fit in memory"))
      ->check(CLI::IsMember({"auto", "jacobi", "gauss-seidel", "southwell", "cg", "gmres"}))
      ->capture_default_str();
  add(command.add_option("--shots", a.shots, "Sides that southwell shoots an iteration, 1 to 256"))
      ->capture_default_str();
  add(command.add_option("--pick", a.pick, "What southwell shoots first: most unshot power, or most radiosity"))
      ->check(CLI::IsMember({"power", "residual"}))
      ->capture_default_str();
  add(command.add_option("--factor-memory", a.factor_mib,
                         "Memory for form factors [MiB], beyond which they are computed on demand (default: three "
                         "quarters of what the device has free)"));
  add(command.add_option("--refine", a.refine,
                         "Patches, at most, once those are cut that light varies on: at shadows' boundaries, near "
                         "lamps. Form factors of the others are kept. 0: none are cut"))
      ->capture_default_str();
  add(command.add_option("--factor-precision", a.precision,
                         "Precision in which form factors are kept: half takes 6 bytes of each instead of 8, and the "
                         "report says how far off that is"))
      ->check(CLI::IsMember({"single", "half"}))
      ->capture_default_str();
  add(command.add_option("--residual-samples", a.residual_samples,
                         "Random points at which the equation of light is tried on the solution; 0: none"))
      ->capture_default_str();
  add(command.add_option("--tolerance", a.tolerance,
                         "Error of the solution that is proven before it stops, relative to the largest radiosity"))
      ->capture_default_str();
  add(command.add_option("--iterations", a.iterations, "Iterations, at most"))->capture_default_str();
  add(command.add_option("--time", a.seconds, "Seconds to solve for, at most; 0: as long as it takes"));
  add(command.add_option("--save", a.save,
                         "Keep what is computed in this file, to go on from with --resume: mesh, form factors, "
                         "solution"));
  add(command.add_option("--resume", a.resume,
                         "Go on from a file of --save, of the same scene and options, and keep in it; the same bits "
                         "come out. One that is finished is shown at once"));
  add(command.add_option("--save-every", a.keep_every, "Seconds between writes of that file, at least"))
      ->check(CLI::Range(0.0, 1e9))
      ->capture_default_str();
  add(command.add_option("--display", a.display, "Light interpolated between vertices, or constant on each patch"))
      ->check(CLI::IsMember({"smooth", "flat"}))
      ->capture_default_str();
  add(command.add_option("--crease", a.crease,
                         "Angle [degrees] beyond which neighbours do not share light at a vertex"))
      ->check(CLI::Range(0.0, 90.0))
      ->capture_default_str();
}

void add_picture_options(CLI::App& command, RadiosityArguments& a) {
  add_to_group(a, command.add_option("--final-gather", a.gather_rays,
                                     "Rays from every diffuse hit that look for light, which is then not the mesh's "
                                     "own but as sharp as it is; lights are sampled as without radiosity (default: "
                                     "none)"))
      ->check(CLI::Range(1U, kMostGatherRays));
}

RadiosityOptions to_radiosity_options(const RadiosityArguments& a, const std::vector<std::string>& others) {
  const auto positive = [](const char* option, double value, bool zero_too) {
    if (!std::isfinite(value) || value < 0.0 || (value == 0.0 && !zero_too)) {
      throw InputError(option, fmt::format("{} is out of range; it must be a positive number", value));
    }
  };
  positive("--edge", a.edge, !is_given(a, "--edge"));
  positive("--chord", a.chord, true);
  positive("--tolerance", a.tolerance, false);
  positive("--time", a.seconds, true);
  positive("--factor-memory", a.factor_mib, !is_given(a, "--factor-memory"));
  check_effective(a);
  if (a.patches == 0) throw InputError("--patches", "0 patches show nothing; give how many there may be");
  RadiosityOptions options;
  options.refine_patches = a.refine;
  options.mesh = {a.edge, a.patches, a.chord};
  for (const SolverKind kind : {SolverKind::automatic, SolverKind::jacobi, SolverKind::gauss_seidel,
                                SolverKind::southwell, SolverKind::cg, SolverKind::gmres}) {
    if (a.solver == to_string(kind)) options.solve.kind = kind;
  }
  if (a.shots < 1 || a.shots > 256) {
    throw InputError("--shots", fmt::format("{} shots an iteration cannot be had; take 1 to 256", a.shots));
  }
  if (a.residual_samples == 1 || a.residual_samples > kMostResidualSamples) {
    throw InputError("--residual-samples", fmt::format("{} points cannot be had; take 0, or 2 to {}",
                                                       a.residual_samples, kMostResidualSamples));
  }
  options.solve.shots = a.shots;
  options.solve.pick = a.pick == "power" ? ShotPick::power : ShotPick::residual;
  options.factor_bytes = static_cast<std::uint64_t>(std::llround(a.factor_mib * kMebibyte));
  options.residual_samples = a.residual_samples;
  const bool by_cubes = is_by_cubes(a);
  options.factors.method = by_cubes                       ? FormFactors::hemicube
                           : a.form_factors == "analytic" ? FormFactors::analytic
                                                          : FormFactors::hybrid;
  options.factors.visibility.few = std::min(options.factors.visibility.few, a.pair_rays);
  options.factors.visibility.many = a.pair_rays;
  options.factors.visibility.seed = a.seed;
  if (a.pair_search == "shafts") options.factors.visibility = by_shafts(options.factors.visibility);
  options.factors.precision = a.precision == "half" ? FactorPrecision::half : FactorPrecision::single;
  HemicubeOptions& hemicube = options.factors.hemicube;
  hemicube.view = a.form_factors == "raster" ? CubeView::raster : CubeView::rays;
  hemicube.resolution = a.resolution > 0 ? a.resolution : (by_cubes ? 64 : kReachResolution);
  hemicube.divisions = divisions_of(a.points);
  hemicube.turned = a.cells != "aligned";
  hemicube.jittered = a.cells == "jittered";
  if (hemicube.jittered && hemicube.view == CubeView::raster) {
    throw InputError("--cells",
                     "jittered cells cannot be drawn; take --form-factors hemicube, whose rays can be jittered");
  }
  hemicube.seed = a.seed;
  check_hemicube_options(hemicube);
  options.solve.tolerance = a.tolerance;
  options.solve.iterations = a.iterations;
  options.solve.seconds = a.seconds;
  options.keep = to_keep_options(a, others);
  return options;
}

std::vector<std::string> left_out_by_radiosity(const Scene& scene) {
  if (scene.ambient == Vec3(0.0F)) return {};
  return {
      fmt::format("radiosity leaves out the scene's ambient light of {:.4g}, {:.4g}, {:.4g} W/m^2/sr: it stands for "
                  "the light between surfaces, which is computed here",
                  scene.ambient.r, scene.ambient.g, scene.ambient.b)};
}

std::vector<std::string> left_out_without_radiosity(const Scene& scene) {
  std::vector<std::string> notes;
  for (const Material& material : scene.materials) {
    if (material.translucency == Vec3(0.0F)) continue;
    notes.push_back(fmt::format("material {}: its translucency is left out by --method whitted; radiosity shows it",
                                in_quotes(material.name)));
  }
  return notes;
}

void tell_kept(const KeepOptions& keep, const RadiosityStatistics& statistics) {
  if (keep.file.empty()) return;
  const char* what = statistics.factors.interrupted
                         ? "form factors pair by pair were not whole and are computed again; the mesh"
                         : "what was computed";
  fmt::print(stderr, "hemiray: {} is in {}; --resume {} goes on\n", what, keep.file, keep.file);
}

DisplayOptions to_display_options(const RadiosityArguments& a) { return {a.display == "smooth", a.crease}; }

std::string radiosity_table(const Radiosity& r) {
  const RadiosityStatistics& s = r.statistics;
  const SolveStep& last = r.solution.history.back();
  std::string text;
  const RefineReport& refinement = s.refinement;
  const bool refined = !refinement.rounds.empty();
  text += fmt::format("mesh          {} patches{} of edges up to {:.3g} m{}, {:.0f} ms\n", r.mesh.patch_count(),
                      refined ? fmt::format(", of {} refined,", refinement.patches) : "", r.mesh.edge_m,
                      r.mesh.chord_m > 0.0 ? fmt::format(", tessellated to {:.2g} m", r.mesh.chord_m) : "", s.mesh_ms);
  if (r.solution.on_demand) {
    text += fmt::format("form factors  {} expected, {} allowed: {} rows computed on demand{}, {} rays\n",
                        format_bytes(s.expected_factor_bytes), format_bytes(s.factor_limit), s.rows,
                        s.precision == FactorPrecision::half ? ", in single precision" : "", s.rays);
  } else {
    text += factor_table(s);
  }
  if (s.rounding) text += rounding_line(*s.rounding, r.solution.rounding_bound);
  text += fmt::format(
      "solution      {}{}, {} iterations, {:.2f} s; no radiosity off by more than {:.3g} of {:.4g} "
      "W/m^2{}{}\n",
      to_string(r.solution.kind), r.solution.why.empty() ? "" : " (" + r.solution.why + ")", last.iteration,
      1e-3 * s.solve_ms, last.bound, r.solution.largest, s.rounding ? ", for the rounded form factors" : "",
      r.solution.converged ? "" : " (not converged)");
  if (!r.solution.converged && r.solution.unshot_w > 0.0) {
    text += fmt::format("unshot        {:.4g} W, shown as {:.3g}, {:.3g}, {:.3g} W/m^2 on all that is lit\n",
                        r.solution.unshot_w, r.solution.ambient[0], r.solution.ambient[1], r.solution.ambient[2]);
  }
  if (r.continuous.samples > 0) {
    const ContinuousResidual& c = r.continuous;
    text += fmt::format(
        "mesh          leaves {:.3g} W/m^2 ({:.3g} to {:.3g}, 95 %) of {:.4g}, root mean squares at {} "
        "points\n",
        c.rms, c.rms_low, c.rms_high, c.radiosity_rms, c.samples);
  }
  text += refinement_table(refinement);
  text += fmt::format("power         {:.6g} W sent, {:.6g} W absorbed\n", s.emitted_w, s.absorbed_w);
  return text;
}

std::string radiosity_json(const Radiosity& r, const std::vector<std::string>& notes) {
  const RadiosityStatistics& s = r.statistics;
  nlohmann::ordered_json json;
  json["notes"] = notes;
  json["patches"] = r.mesh.patch_count();
  json["edge_m"] = r.mesh.edge_m;
  json["chord_m"] = r.mesh.chord_m;
  json["rows"] = s.rows;
  json["kept_rows"] = s.kept_rows;
  json["entries"] = s.entries;
  json["factor_bytes"] = s.factor_bytes;
  json["rays"] = s.rays;
  json["form_factors"] = factor_json(s.factors);
  json["factor_precision"] = to_string(s.rounding ? FactorPrecision::half : FactorPrecision::single);
  if (s.rounding) json["factor_rounding"] = rounding_json(*s.rounding, r.solution.rounding_bound);
  json["mesh_ms"] = s.mesh_ms;
  json["tree_ms"] = s.tree_ms;
  json["factors_ms"] = s.factors_ms;
  json["solve_ms"] = s.solve_ms;
  json["solve_compile_ms"] = s.solve_compile_ms;
  json["peak_bytes"] = s.peak_bytes;
  json["emitted_w"] = s.emitted_w;
  json["absorbed_w"] = s.absorbed_w;
  json["factor_bytes_at_most"] = s.factor_bytes_at_most;
  json["expected_factor_bytes"] = s.expected_factor_bytes;
  json["factor_limit_bytes"] = s.factor_limit;
  json["solver"] = to_string(r.solution.kind);
  json["solver_why"] = r.solution.why;
  json["on_demand"] = r.solution.on_demand;
  json["unshot_w"] = r.solution.unshot_w;
  json["ambient"] = r.solution.ambient;
  if (r.continuous.samples > 0) {
    json["continuous_residual"] = residual_json(r.continuous);
    json["continuous_residual"]["milliseconds"] = s.residual_ms;
  }
  if (!s.refinement.end.empty()) json["refinement"] = refinement_json(s.refinement);
  json["converged"] = r.solution.converged;
  json["largest_radiosity"] = r.solution.largest;
  for (const SolveStep& step : r.solution.history) {
    nlohmann::ordered_json one;
    one["iteration"] = step.iteration;
    one["residual"] = step.residual;
    if (std::isfinite(step.bound)) {
      one["bound"] = step.bound;
    } else {
      one["bound"] = nullptr;
    }
    one["seconds"] = step.seconds;
    json["history"].push_back(one);
  }
  return json.dump(2) + "\n";
}

}  // namespace hemiray::app
