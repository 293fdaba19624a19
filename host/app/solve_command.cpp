// `hemiray solve SCENE -o FILE.glb`: diffuse light that does not depend on where one looks from.
#include <fmt/format.h>

#include <cstdio>
#include <memory>

#include "host/app/commands.hpp"
#include "host/app/radiosity_arguments.hpp"
#include "host/base/atomic_file.hpp"
#include "host/base/error.hpp"
#include "host/base/interrupt.hpp"
#include "host/base/progress.hpp"
#include "host/radiosity/export_glb.hpp"
#include "host/scene/load.hpp"

namespace hemiray::app {
namespace {

constexpr const char* kExamples = R"(Examples:
  hemiray solve scenes/cornell_box.json -o cornell.glb                  walk around in any glTF viewer
  hemiray solve room.json -o room.glb --patches 20000 --points 4 --json > room.stats.json
  hemiray solve room.json -o room.glb --patches 4000 --refine 12000     small patches where light varies
  hemiray solve room.json -o room.glb --edge 0.05 --solver jacobi --tolerance 1e-6
  hemiray solve room.json -o room.glb --patches 50000 --save room.solution      killed, or the machine fails; then
  hemiray solve room.json -o room.glb --patches 50000 --resume room.solution    goes on: the same bits

The file holds the patches that light comes to, unlit, with the radiosity of every corner: exposed as COLOR_0, and in
W/m^2 as _RADIOSITY. Interrupt (Ctrl-C) ends the solution, writes what is there and exits with 130. A file of --save is
for render --method radiosity, too, with the same options of radiosity, but for --refine: it has the solution before.)";

struct SolveArguments {
  std::string scene, output, device;
  double exposure = 0.0;
  bool quiet = false, json = false;
  RadiosityArguments radiosity;
};

int run_solve(const SolveArguments& given) {
  RadiosityOptions options = to_radiosity_options(given.radiosity, {given.scene, given.output});
  if (!given.output.ends_with(".glb")) {
    throw InputError("--output", fmt::format("'{}' does not end in .glb", given.output));
  }
  check_writable(given.output);
  Scene scene = load_scene(given.scene);
  for (const std::string& note : left_out_by_radiosity(scene)) scene.notes.push_back(note);
  if (!given.quiet) {
    for (const std::string& note : scene.notes) fmt::print(stderr, "hemiray: note: {}\n", note);
  }
  Context context(choose_device(given.device, "--device"));
  const InterruptGuard interrupt;
  Progress progress("solve", !given.quiet);
  options.on_progress = [&](const std::string&, double fraction) {
    progress.update(fraction, 0.0);
    return !interrupt.interrupted();
  };
  options.solve.on_iteration = [&](std::uint32_t, double) { return !interrupt.interrupted(); };
  const Radiosity radiosity = compute_radiosity(context, flatten_scene(scene), options);
  progress.finish();
  GlbFacts facts;
  write_file_atomically(given.output, solution_as_glb(radiosity.mesh, radiosity.irradiance,
                                                      to_display_options(given.radiosity), given.exposure, facts));
  if (given.json) {
    std::fputs(radiosity_json(radiosity, scene.notes).c_str(), stdout);
  } else if (!given.quiet) {
    std::fputs(radiosity_table(radiosity).c_str(), stdout);
    fmt::print("wrote         {} (radiosities times {:.4g})\n", given.output, facts.exposure);
  }
  if (!interrupt.interrupted()) return static_cast<int>(ExitCode::ok);
  fmt::print(stderr, "hemiray: interrupted; wrote {} as far as it got\n", given.output);
  tell_kept(options.keep, radiosity.statistics);
  return static_cast<int>(ExitCode::interrupted);
}

}  // namespace

void add_solve_command(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand("solve", "Solve a scene's diffuse light by radiosity, to a glTF file");
  const auto given = std::make_shared<SolveArguments>();
  command->add_option("SCENE", given->scene, "Scene: .json, .gltf, .glb, .obj or .ply")->required()->type_name("FILE");
  command->add_option("-o,--output", given->output, "Solution to write, .glb")->required()->type_name("FILE");
  command->add_option("--device", given->device, "Index, part of a name, cpu or gpu (default: HEMIRAY_DEVICE)");
  command->add_option("--exposure", given->exposure, "Factor of radiosities for COLOR_0 (default: what shows the room)")
      ->check(CLI::Range(1e-30, 1e30));
  command->add_option("--seed", given->radiosity.seed, "Seed of the random numbers")->capture_default_str();
  command->add_flag("--quiet", given->quiet, "Print nothing but errors");
  command->add_flag("--json", given->json, "Print statistics as JSON on stdout");
  add_radiosity_options(*command, given->radiosity);
  command->footer(kExamples);
  command->callback([given, &exit_code] { exit_code = run_solve(*given); });
}

}  // namespace hemiray::app
