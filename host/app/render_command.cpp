// `hemiray render SCENE -o FILE`.
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>

#include "host/app/commands.hpp"
#include "host/app/process_clock.hpp"
#include "host/app/radiosity_arguments.hpp"
#include "host/app/render_report.hpp"
#include "host/base/atomic_file.hpp"
#include "host/base/error.hpp"
#include "host/base/exr.hpp"
#include "host/base/interrupt.hpp"
#include "host/base/png.hpp"
#include "host/base/progress.hpp"
#include "host/gpu/device_list.hpp"
#include "host/path/render.hpp"
#include "host/scene/load.hpp"

namespace hemiray::app {
namespace {

constexpr const char* kExamples = R"(Examples:
  hemiray render scenes/cornell_box.json -o cornell.exr
  hemiray render model.glb -o model.exr --png model.png --exposure 1 --size 1024x768 --spp 16
  hemiray render scenes/glass_and_mirror.json -o a.exr --engine megakernel --strict --json > a.json
  hemiray render scene.obj -o out.exr --device gpu --trace trace.json
  hemiray render model.ply -o out.exr --accel octree --triangle fast
  hemiray render scenes/cornell_box.json -o cornell.exr --method radiosity --patches 10000
  hemiray render scenes/cornell_box.json -o cornell.exr --method radiosity --patches 1000 --final-gather 64
  hemiray render room.json -o a.exr --method radiosity --save room.solution      solves, and keeps what is computed
  hemiray render room.json -o b.exr --method radiosity --resume room.solution    goes on, or shows it, from elsewhere, too
  hemiray render scene.gltf -o out.exr --device all      every device, tiles by what each delivers
  hemiray render scene.gltf -o out.exr --device cpu,1    these two
  hemiray render scene.gltf -o out.exr --device split:2  one device as two sub-devices

The EXR holds the layers beauty (R, G, B, A; W/m^2/sr), depth (m), normal, albedo, id, direct, reflection,
refraction. id counts from 1: meshes and quads, spheres, disks to implicit surfaces, planes, visible area lights, each
kind in the scene's order; 0 is the background. Devices of one kind give the same bits, alone or together; one that fails on the way is
dropped with a message, and the others do its part.
Interrupt (Ctrl-C) finishes the pass, writes what is there and exits with 130.)";

struct RenderArguments {
  std::string scene, output, device, method = "whitted", engine = "wavefront", accel = "bvh", tree = "quality",
                                     triangle = "watertight", rays = "auto", terminator = "smooth",
                                     precision = "single", size, png, trace, dump_kernels;
  int spp = 4, depth = -1;
  std::uint32_t seed = 0;
  double exposure = 0.0;
  bool has_tree = false, strict = false, quiet = false, json = false;
  RadiosityArguments radiosity;
};

// "640x480" -> width and height.
std::pair<int, int> parse_size(const std::string& text) {
  const std::string help = fmt::format("'{}' is not a size; write WIDTHxHEIGHT in pixels, such as 640x480", text);
  const std::size_t cross = text.find_first_of("xX");
  if (cross == std::string::npos) throw InputError("--size", help);
  const auto number = [&help](const std::string& digits) {
    if (digits.empty() || digits.find_first_not_of("0123456789") != std::string::npos) {
      throw InputError("--size", help);
    }
    if (digits.size() > 6) throw InputError("--size", fmt::format("{} pixels are too many on a side", digits));
    return std::stoi(digits);
  };
  const std::pair<int, int> size{number(text.substr(0, cross)), number(text.substr(cross + 1))};
  if (size.first == 0 || size.second == 0) throw InputError("--size", "a picture of no pixels cannot be rendered");
  return size;
}

bool ends_with(const std::string& text, const std::string& end) {
  return text.size() >= end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
}

// An option without effect is a mistake: who gives it expects one.
void check_effective(const RenderArguments& given, const RenderOptions& options) {
  const bool groups = given.rays == "packets" || given.rays == "sorted";
  if (groups && options.engine == EngineKind::megakernel) {
    throw InputError("--rays " + given.rays,
                     "only the wavefront groups rays, not --engine megakernel; leave one of the two out");
  }
  if (given.exposure != 0.0 && given.png.empty()) {
    throw InputError("--exposure", "is for the picture of --png, which is not asked for; name one, or leave it out");
  }
  for (const CLI::Option* option : given.radiosity.given) {
    if (option->count() > 0 && given.method != "radiosity") {
      throw InputError(option->get_name(), "is for --method radiosity, which is not asked for; leave it out");
    }
  }
  if (given.has_tree && options.accel.kind != AccelKind::bvh) {
    throw InputError("--tree " + given.tree, "is for bvh and bvh2; leave it out with --accel " + given.accel);
  }
}

RenderOptions to_options(const RenderArguments& given) {
  RenderOptions options;
  options.engine = given.engine == "megakernel" ? EngineKind::megakernel : EngineKind::wavefront;
  options.accel = parse_accel(given.accel);
  check_effective(given, options);
  options.accel.builder = given.tree == "fast" ? TreeBuilder::fast : TreeBuilder::quality;
  options.accel.triangle_test = given.triangle == "fast" ? TriangleTest::fast : TriangleTest::watertight;
  if (given.rays == "single") options.rays = RayGrouping::single;
  if (given.rays == "packets") options.rays = RayGrouping::packets;
  if (given.rays == "sorted") options.rays = RayGrouping::sorted;
  if (!given.size.empty()) std::tie(options.width, options.height) = parse_size(given.size);
  options.spp = given.spp;
  options.depth = given.depth;
  options.seed = given.seed;
  options.strict = given.strict;
  options.smooth_terminator = given.terminator == "smooth";
  options.double_precision = given.precision == "double";
  return options;
}

// "a + b": each once.
std::string joined(const std::vector<std::string>& names) {
  std::string text;
  for (auto name = names.begin(); name != names.end(); ++name) {
    if (std::find(names.begin(), name, *name) == name) text += (text.empty() ? "" : " + ") + *name;
  }
  return text;
}

RenderFacts gather_facts(const RenderArguments& given, const Scene& scene, const RenderOptions& options,
                         const std::vector<DeviceInfo>& devices) {
  RenderFacts facts;
  facts.scene = given.scene;
  facts.output = given.output;
  std::vector<std::string> names, platforms, drivers;
  for (const DeviceInfo& device : devices) {
    names.push_back(label_of(device));
    platforms.push_back(device.platform);
    drivers.push_back(device.driver);
  }
  facts.device = joined(names);
  facts.platform = joined(platforms);
  facts.driver = joined(drivers);
  facts.engine = given.engine;
  facts.width = options.width > 0 ? options.width : scene.camera.width;
  facts.height = options.height > 0 ? options.height : scene.camera.height;
  facts.seed = given.seed;
  facts.strict = given.strict;
  facts.terminator = given.terminator;
  facts.precision = given.precision;
  facts.spp = given.spp;
  facts.depth = given.depth >= 0 ? given.depth : scene.depth;
  const std::string tree = options.accel.kind == AccelKind::bvh ? " --tree " + given.tree : "";
  facts.options = fmt::format(
      "--method {} --engine {} --accel {}{} --triangle {} --rays {} --terminator {} --precision {} --size {}x{} --spp "
      "{} --depth "
      "{} --seed {}{}",
      given.method, facts.engine, given.accel, tree, given.triangle, given.rays, given.terminator, given.precision,
      facts.width, facts.height, facts.spp, facts.depth, facts.seed, facts.strict ? " --strict" : "");
  facts.notes = scene.notes;
  return facts;
}

void check_outputs(const RenderArguments& given) {
  if (!ends_with(given.output, ".exr")) {
    throw InputError("--output",
                     fmt::format("'{}' does not end in .exr; a PNG is written beside it with --png", given.output));
  }
  if (!given.png.empty() && !ends_with(given.png, ".png")) {
    throw InputError("--png", fmt::format("'{}' does not end in .png", given.png));
  }
  // The range check of the option lets NaN pass.
  if (std::isnan(given.exposure)) throw InputError("--exposure", "not a number; give stops, such as 1 or -0.5");
  check_writable(given.output);
  if (!given.png.empty()) check_writable(given.png);
  if (given.trace.empty()) return;
  check_writable(given.trace);
  for (const std::string& other : {given.scene, given.output, given.png}) {
    if (!other.empty() && is_same_file(other, given.trace)) {
      throw InputError("--trace", fmt::format("'{}' would overwrite the scene or the picture", given.trace));
    }
  }
}

// Over the progress bar, if there is one; it is drawn again below.
void print_lost_device(const std::string& message) {
  constexpr std::size_t kWidestBar = 110;
  const bool terminal = isatty(STDERR_FILENO) == 1;
  fmt::print(stderr, "{}{:<{}}\n", terminal ? "\r" : "", "hemiray: warning: " + message, terminal ? kWidestBar : 0);
}

// The scene's diffuse light, and its surfaces lit by it.
struct LitScene {
  Radiosity radiosity;
  FlatScene patches;
};

LitScene solve_light(const RenderArguments& given, const Scene& scene, const DeviceInfo& device,
                     const InterruptGuard& interrupt) {
  RadiosityOptions options = to_radiosity_options(given.radiosity, {given.scene, given.output, given.png, given.trace});
  options.factors.hemicube.seed = options.factors.visibility.seed = given.seed;
  Progress progress("form factors", !given.quiet);
  options.on_progress = [&](const std::string&, double fraction) {
    progress.update(fraction, 0.0);
    return !interrupt.interrupted();
  };
  options.solve.on_iteration = [&](std::uint32_t, double) { return !interrupt.interrupted(); };
  Context context(device);
  LitScene lit;
  const FlatScene flat = flatten_scene(scene);
  const DisplayOptions display = to_display_options(given.radiosity);
  const std::uint32_t rays = given.radiosity.gather_rays;
  lit.radiosity = compute_radiosity(context, flat, options);
  if (interrupt.interrupted()) tell_kept(options.keep, lit.radiosity.statistics);
  const Radiosity& r = lit.radiosity;
  lit.patches = rays > 0 ? gathered_patches(flat, r.mesh, r.irradiance, rays, display)
                         : lit_patches(r.mesh, r.irradiance, display);
  return lit;
}

int run_render(const RenderArguments& given) {
  RenderOptions options = to_options(given);
  check_outputs(given);
  if (!given.dump_kernels.empty()) setenv("HEMIRAY_DUMP_KERNELS", given.dump_kernels.c_str(), 1);
  const double load_start = seconds_since_process_start();
  Scene scene = load_scene(given.scene);
  const double loaded = seconds_since_process_start();
  const bool by_radiosity = given.method == "radiosity";
  for (const std::string& note : by_radiosity ? left_out_by_radiosity(scene) : left_out_without_radiosity(scene)) {
    scene.notes.push_back(note);
  }
  if (!given.quiet) {
    for (const std::string& note : scene.notes) fmt::print(stderr, "hemiray: note: {}\n", note);
  }
  const std::vector<DeviceInfo> devices = choose_devices(given.device);
  RenderFacts facts = gather_facts(given, scene, options, devices);
  facts.load_ms = (loaded - load_start) * 1e3;

  const InterruptGuard interrupt;
  LitScene lit;
  if (by_radiosity) {
    lit = solve_light(given, scene, devices.front(), interrupt);
    options.patches = &lit.patches;
    facts.radiosity = radiosity_json(lit.radiosity, scene.notes);
    if (!given.quiet && !given.json) std::fputs(radiosity_table(lit.radiosity).c_str(), stdout);
  }
  Progress progress("render", !given.quiet);
  options.on_progress = [&progress](double fraction, double rate) { progress.update(fraction, rate); };
  options.on_first_pass = [&facts] { facts.first_pixel_s = seconds_since_process_start(); };
  options.should_stop = [&interrupt] { return interrupt.interrupted(); };
  options.on_device_lost = print_lost_device;
  options.keep_spans = !given.trace.empty();
  RenderResult result = render_on_devices(devices, scene, options);
  progress.finish();

  facts.total_s = seconds_since_process_start();
  result.image.metadata = report_metadata(facts, result.statistics);
  write_exr(given.output, result.image);
  if (!given.png.empty()) write_png(given.png, result.image, "", given.exposure);
  if (!given.trace.empty()) write_file_atomically(given.trace, report_trace(result.statistics.devices));
  if (given.json) {
    std::fputs(report_json(facts, result.statistics).c_str(), stdout);  // main() tells what went wrong
  } else if (!given.quiet) {
    std::fputs(report_table(facts, result.statistics).c_str(), stdout);
  }
  if (result.statistics.interrupted) {
    fmt::print(stderr, "hemiray: interrupted after {} of {} samples; wrote {}\n", result.statistics.passes, given.spp,
               given.output);
    return static_cast<int>(ExitCode::interrupted);
  }
  return static_cast<int>(ExitCode::ok);
}

}  // namespace

void add_render_command(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand("render", "Render a scene to an OpenEXR file");
  const auto given = std::make_shared<RenderArguments>();
  command->add_option("SCENE", given->scene, "Scene: .json, .gltf, .glb, .obj or .ply")->required()->type_name("FILE");
  command->add_option("-o,--output", given->output, "Picture to write, .exr")->required()->type_name("FILE");
  command->add_option("--png", given->png, "Write an sRGB PNG of the beauty layer, too");
  command->add_option("--exposure", given->exposure, "Stops by which the PNG of --png is made brighter")
      ->check(CLI::Range(-64.0, 64.0));
  command->add_option(
      "--device", given->device,
      "Index, part of a name, cpu, gpu, all, split:N (sub-devices), or a list with commas (default: HEMIRAY_DEVICE)");
  command
      ->add_option(
          "--method", given->method,
          "whitted: light from lights, mirrors and glass; radiosity: all diffuse light, mirrors and glass on top")
      ->check(CLI::IsMember({"whitted", "radiosity"}))
      ->capture_default_str();
  command->add_option("--engine", given->engine, "How paths are run; the pictures agree, with --strict to the bit")
      ->check(CLI::IsMember({"wavefront", "megakernel"}))
      ->capture_default_str();
  command->add_option("--size", given->size, "WIDTHxHEIGHT in pixels (default: the scene's)");
  command->add_option("--spp", given->spp, "Samples a pixel, from 1 on")->capture_default_str();
  command->add_option("--depth", given->depth, "Bounces of mirrors and glass, 0 to 64 (default: the scene's)")
      ->check(CLI::Range(0, 64));
  command->add_option("--seed", given->seed, "Seed of the random numbers")->capture_default_str();
  command->add_option("--accel", given->accel, "Acceleration structure; all give the same hits")
      ->check(CLI::IsMember({"bvh", "bvh2", "octree", "kdtree", "kdtree-median"}))
      ->capture_default_str();
  CLI::Option* tree =
      command->add_option("--tree", given->tree, "How a bvh is built: quality traces faster, fast builds faster")
          ->check(CLI::IsMember({"quality", "fast"}))
          ->capture_default_str();
  command->add_option("--triangle", given->triangle, "Triangle test; watertight lets no ray slip between neighbours")
      ->check(CLI::IsMember({"watertight", "fast"}))
      ->capture_default_str();
  command
      ->add_option("--rays", given->rays,
                   "How the wavefront traces: single rays, packets of those with one origin, reflected and refracted "
                   "ones sorted; auto takes what pays")
      ->check(CLI::IsMember({"auto", "single", "packets", "sorted"}))
      ->capture_default_str();
  command
      ->add_option("--terminator", given->terminator,
                   "Shadows on smooth-shaded triangles: smooth starts shadow rays on the surface the normals tell of, "
                   "hard on the triangles, which then show at the shadow's edge")
      ->check(CLI::IsMember({"smooth", "hard"}))
      ->capture_default_str();
  command
      ->add_option("--precision", given->precision,
                   "double computes rays, hits and shading in double precision, two to four times slower; trees and "
                   "the picture's sums stay single")
      ->check(CLI::IsMember({"single", "double"}))
      ->capture_default_str();
  command->add_flag("--strict", given->strict, "Both engines give the same bits; some speed is lost");
  command->add_flag("--quiet", given->quiet, "Print nothing but errors");
  command->add_flag("--json", given->json, "Print statistics as JSON on stdout");
  command->add_option("--trace", given->trace, "Write a timeline in Chrome's trace format");
  command->add_option("--dump-kernels", given->dump_kernels, "Write the flattened kernel sources to this folder");
  add_radiosity_options(*command, given->radiosity);
  add_picture_options(*command, given->radiosity);
  command->footer(kExamples);
  command->callback([given, tree, &exit_code] {
    given->has_tree = tree->count() > 0;
    exit_code = run_render(*given);
  });
}

}  // namespace hemiray::app
