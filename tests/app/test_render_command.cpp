// `hemiray render` as a user runs it: files, layers, statistics, options.
#include <catch2/catch.hpp>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <regex>

#include "host/base/clock.hpp"
#include "host/base/exr.hpp"
#include "host/base/image_decode.hpp"
#include "tests/app/small_scenes.hpp"
#include "tests/support/profile_file.hpp"
#include "tests/support/run_program.hpp"
#include "tests/support/temp_folder.hpp"

using namespace hemiray;
using namespace hemiray::test;
using nlohmann::json;
namespace fs = std::filesystem;
using Words = std::vector<std::string>;

namespace {

/// A folder with both scenes, and renders into it.
struct Renders {
  TempFolder folder;
  std::string matte = folder.write("matte.json", kMatteScene).string();
  std::string glass = folder.write("glass.json", kGlassScene).string();

  [[nodiscard]] std::string path(const std::string& name) const { return (folder / name).string(); }
  /// Must succeed without a word on stderr.
  [[nodiscard]] ProgramResult run(const std::string& scene, const std::string& output, const Words& options) const {
    Words arguments{"render", scene, "-o", path(output)};
    arguments.insert(arguments.end(), options.begin(), options.end());
    ProgramResult result = run_program(arguments);
    INFO(result.err);
    REQUIRE(result.exit_code == 0);
    CHECK(result.err.empty());
    return result;
  }
  [[nodiscard]] Image image(const std::string& scene, const std::string& output, const Words& options) const {
    static_cast<void>(run(scene, output, options));
    return read_exr(path(output));
  }
  [[nodiscard]] json statistics(const std::string& scene, const Words& options) const {
    Words all{"--json"};
    all.insert(all.end(), options.begin(), options.end());
    return json::parse(run(scene, "statistics.exr", all).out);
  }
};

bool same_bits(const Image& a, const Image& b) {
  REQUIRE(a.layers.size() == b.layers.size());
  for (std::size_t i = 0; i < a.layers.size(); ++i) {
    REQUIRE(a.layers[i].name == b.layers[i].name);
    if (a.layers[i].data != b.layers[i].data) return false;
  }
  return true;
}

/// While it lives every path runs through the kernels of the stages; small pictures would otherwise be all tail.
struct StagesToTheEnd {
  test::ProfileFile file{test::ProfileFile::for_all(R"("tail_paths": 0)")};
};

std::set<std::string> stage_names(const json& statistics) {
  std::set<std::string> names;
  for (const json& stage : statistics["stages"]) names.insert(stage["name"]);
  return names;
}

bool has_effect(const json& statistics, const std::string& name) {
  const json& effects = statistics["effects"];
  return std::find(effects.begin(), effects.end(), name) != effects.end();
}

double mean_of_png(const std::string& file) {
  const std::string text = read_whole_file(file);
  const DecodedImage image =
      decode_image(std::span(reinterpret_cast<const std::uint8_t*>(text.data()), text.size()), file);
  CHECK(image.width == 24);
  CHECK(image.height == 16);
  double sum = 0.0;
  for (const std::uint8_t value : image.rgba) sum += value;
  return sum / static_cast<double>(image.rgba.size());
}

}  // namespace

TEST_CASE("render writes every layer, and beauty is the sum of its three parts") {
  const Renders renders;
  const Image image = renders.image(renders.glass, "a.exr", {"--spp", "3"});
  CHECK(image.width == 24);
  CHECK(image.height == 16);
  const std::map<std::string, Words> expected{{"", {"R", "G", "B", "A"}},
                                              {"depth", {"Z"}},
                                              {"normal", {"X", "Y", "Z"}},
                                              {"albedo", {"R", "G", "B"}},
                                              {"id", {"id"}},
                                              {"direct", {"R", "G", "B"}},
                                              {"reflection", {"R", "G", "B"}},
                                              {"refraction", {"R", "G", "B"}}};
  CHECK(image.layers.size() == expected.size());
  for (const auto& [name, channels] : expected) {
    CAPTURE(name);
    const Layer* layer = image.find(name);
    REQUIRE(layer != nullptr);
    CHECK(layer->channels == channels);
    CHECK(layer->data.size() == image.pixel_count() * channels.size());
    CHECK(brightest(image, name) > 0.0F);
  }
  CHECK(has_no_nan(image));
  const std::vector<float>& beauty = image.find("")->data;
  // The sum is rounded once on either side, in another order.
  constexpr double kRounding = 1e-5;
  for (std::size_t i = 0; i < image.pixel_count(); ++i) {
    for (std::size_t c = 0; c < 3; ++c) {
      const float sum = image.find("direct")->data[i * 3 + c] + image.find("reflection")->data[i * 3 + c] +
                        image.find("refraction")->data[i * 3 + c];
      CHECK(beauty[i * 4 + c] == Approx(sum).epsilon(kRounding).margin(1e-12));
    }
    CHECK(beauty[i * 4 + 3] >= 0.0F);
    CHECK(beauty[i * 4 + 3] <= 1.0F);
  }
  CHECK(listing(renders.folder.path()) == std::set<std::string>{"a.exr", "glass.json", "matte.json"});
}

TEST_CASE("the picture's header says how it was made") {
  const Renders renders;
  const Words options{"--size", "20x10", "--spp",    "2",          "--depth", "2",
                      "--seed", "77",    "--engine", "megakernel", "--strict"};
  Image image = renders.image(renders.glass, "a.exr", options);
  CHECK(image.width == 20);
  CHECK(image.height == 10);
  const json device = renders.statistics(renders.matte, {"--spp", "1"})["device"];
  auto& header = image.metadata;
  const std::string version = run_program({"--version"}).out;
  CHECK(version == "hemiray " + header["version"] + " (" + header["commit"] + ")\n");
  CHECK_FALSE(header["version"].empty());
  CHECK_FALSE(header["commit"].empty());
  CHECK_THAT(header["device"], Catch::Contains(device["name"].get<std::string>()));
  CHECK(header["driver"] == device["driver"]);
  CHECK(header["options"] ==
        "--method whitted --engine megakernel --accel bvh --tree quality --triangle watertight --rays auto "
        "--terminator smooth --precision single --size 20x10 --spp 2 --depth 2 "
        "--seed 77 --strict");
  CHECK(header["engine"] == "megakernel");
  CHECK(header["seed"] == "77");
  CHECK(header["samples"] == "2");
  CHECK(header["strict"] == "true");
  CHECK(header["scene"] == renders.glass);
  CHECK_THAT(header["effects"], Catch::Contains("refraction"));
  for (const char* timing : {"build_ms", "trace_ms"}) CHECK(std::stod(header[timing]) > 0.0);
  // Options that can be given again.
  Image cells = renders.image(renders.matte, "b.exr", {"--size", "20x10", "--spp", "1", "--accel", "octree"});
  CHECK_THAT(cells.metadata["options"], Catch::Contains("--accel octree --triangle watertight "));
}

TEST_CASE("render --png writes a PNG beside the EXR, and --exposure makes it brighter or darker") {
  const Renders renders;
  const auto mean = [&](const std::string& exposure) {
    static_cast<void>(renders.run(renders.matte, "a.exr", {"--png", renders.path("a.png"), "--exposure", exposure}));
    return mean_of_png(renders.path("a.png"));
  };
  const double plain = mean("0");
  CHECK(plain > 0.0);
  CHECK(mean("1") > plain);
  CHECK(mean("-3") < plain);
  CHECK(same_bits(read_exr(renders.path("a.exr")), renders.image(renders.matte, "b.exr", {})));
}

TEST_CASE("render --json holds the statistics") {
  const Renders renders;
  const json with_tail = renders.statistics(renders.glass, {"--spp", "2", "--seed", "5"});
  const StagesToTheEnd stages;
  const json all = renders.statistics(renders.glass, {"--spp", "2", "--seed", "5"});
  CHECK(all["first_pixel_s"].get<double>() > 0.0);
  CHECK(all["total_s"].get<double>() >= all["first_pixel_s"].get<double>());
  CHECK(all["peak_device_bytes"].get<std::uint64_t>() > 24 * 16 * 16);
  CHECK(all["rays"]["closest"].get<std::uint64_t>() >= 24 * 16 * 2);
  CHECK(all["rays"]["shadow"].get<std::uint64_t>() > 0);
  CHECK(all["passes"] == 2);
  CHECK(all["interrupted"] == false);
  CHECK(all["options"]["seed"] == 5);
  CHECK(all["options"]["width"] == 24);
  CHECK(all["options"]["engine"] == "wavefront");
  CHECK(all["scene"]["primitives"] == 7);  // floor, mirror and visible lamp of two triangles each, one sphere
  CHECK(all["output"] == renders.path("statistics.exr"));
  REQUIRE_FALSE(all["programs"].empty());
  for (const json& program : all["programs"]) {
    CHECK(program["kernels"].get<int>() > 0);
    CHECK(program["ms"].get<double>() > 0.0);
    CHECK(program["cached"].is_boolean());
  }
  REQUIRE_FALSE(all["stages"].empty());
  std::uint64_t generated = 0;
  std::uint64_t closest = 0;
  for (const json& stage : all["stages"]) {
    CAPTURE(stage.dump());
    CHECK(stage["launches"].get<int>() > 0);
    CHECK(stage["items"].get<std::uint64_t>() >= stage["launches"].get<std::uint64_t>());  // never an empty queue
    CHECK(stage["ms"].get<double>() >= 0.0);
    if (stage["name"] == "path_generate") generated = stage["items"];
    if (stage["name"] == "path_intersect_closest") closest = stage["items"];
  }
  CHECK(generated == 24 * 16 * 2);
  CHECK(closest == all["rays"]["closest"]);
  CHECK(stage_names(with_tail).count("path_finish") == 1);
  CHECK(with_tail["rays"]["closest"].get<double>() == Approx(all["rays"]["closest"].get<double>()).epsilon(1e-3));
  CHECK(with_tail["rays"]["shadow"].get<double>() == Approx(all["rays"]["shadow"].get<double>()).epsilon(1e-3));
}

TEST_CASE("the time to the first picture counts from the end of the build that ./hemiray began with") {
  const Renders renders;
  // A shell that "builds" for a second, then becomes the program, as the wrapper does.
  const std::string output = renders.path("statistics.json");
  const std::string render = "'" HR_PROGRAM "' render '" + renders.matte + "' -o '" + renders.path("a.exr") + "'";
  const std::string shell = "sleep 1; read -r HEMIRAY_BUILT_AT _ </proc/uptime; export HEMIRAY_BUILT_AT; exec ";
  const double start = steady_ms();
  REQUIRE(std::system((shell + render + " --spp 1 --json >'" + output + "'").c_str()) == 0);
  const double all_s = (steady_ms() - start) * 1e-3;
  const json statistics = json::parse(read_whole_file(output));
  CHECK(statistics["first_pixel_s"].get<double>() > 0.0);
  CHECK(statistics["first_pixel_s"].get<double>() < statistics["total_s"].get<double>());
  constexpr double kClockTick = 0.02;  // [s]: what both clocks of the system are rounded to
  CHECK(statistics["total_s"].get<double>() < all_s - 1.0 + kClockTick);
}

TEST_CASE("render prints a table, on --quiet nothing, and no progress bar into a pipe") {
  const Renders renders;
  const StagesToTheEnd stages;
  const ProgramResult table = renders.run(renders.glass, "a.exr", {"--spp", "1"});
  for (const char* word : {"scene", "effects", "refraction", "device", "compile", "build", "trace", "rays/s",
                           "path_shade_surface", "launches", "Mrays/s", "peak memory"}) {
    CHECK_THAT(table.out, Catch::Contains(word));
  }
  CHECK_THAT(table.out, Catch::Contains(", 1 node, ") && Catch::Contains("7 primitives, 0 planes, 1 light, "));
  const ProgramResult quiet = renders.run(renders.glass, "a.exr", {"--spp", "1", "--quiet"});
  CHECK(quiet.out.empty());

  // What a loader assumed is a note on stderr, not with --quiet.
  const std::string bare = renders.folder.write("bare.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").string();
  const ProgramResult noted = run_program({"render", bare, "-o", renders.path("b.exr"), "--size", "8x8"});
  CHECK(noted.exit_code == 0);
  CHECK_THAT(noted.err, Catch::Contains("hemiray: note: ") && Catch::Contains("camera"));
  const ProgramResult silent = run_program({"render", bare, "-o", renders.path("b.exr"), "--size", "8x8", "--quiet"});
  CHECK(silent.exit_code == 0);
  CHECK(silent.err.empty());
}

TEST_CASE("render runs only what the scene calls for") {
  const Renders renders;
  const StagesToTheEnd stages;
  const json matte = renders.statistics(renders.matte, {"--spp", "1"});
  const json glass = renders.statistics(renders.glass, {"--spp", "1"});
  for (const char* effect : {"reflection", "refraction", "spheres", "area-lights"}) {
    CAPTURE(effect);
    CHECK_FALSE(has_effect(matte, effect));
    CHECK(has_effect(glass, effect));
  }
  CHECK(has_effect(matte, "point-lights"));
  for (const char* stage : {"path_scatter", "path_next_branch"}) {
    CAPTURE(stage);
    CHECK(stage_names(matte).count(stage) == 0);
    CHECK(stage_names(glass).count(stage) == 1);
  }
  CHECK(matte["peak_device_bytes"].get<std::uint64_t>() < glass["peak_device_bytes"].get<std::uint64_t>());
  // Without bounces nobody sees that glass is glass.
  const json flat = renders.statistics(renders.glass, {"--spp", "1", "--depth", "0"});
  CHECK_FALSE(has_effect(flat, "refraction"));
  CHECK(stage_names(flat).count("path_scatter") == 0);
}

TEST_CASE("render --trace is a timeline in Chrome's format") {
  const Renders renders;
  const StagesToTheEnd stages;
  static_cast<void>(renders.run(renders.glass, "a.exr", {"--spp", "1", "--trace", renders.path("t.json"), "--quiet"}));
  const json trace = json::parse(read_whole_file(renders.path("t.json")));
  std::set<std::string> kernels;
  std::set<std::string> threads;
  for (const json& event : trace["traceEvents"]) {
    CAPTURE(event.dump());
    CHECK(event["pid"].is_number());
    CHECK(event["tid"].is_number());
    if (event["ph"] == "M") {
      threads.insert(event["args"]["name"].get<std::string>());
      continue;
    }
    REQUIRE(event["ph"] == "X");
    CHECK(event["dur"].get<double>() >= 0.0);
    CHECK(std::isfinite(event["ts"].get<double>()));
    if (event["cat"] == "kernel") kernels.insert(event["name"].get<std::string>());
  }
  CHECK(threads == std::set<std::string>{"host", "device"});
  for (const char* name : {"path_generate", "path_shade_surface", "path_scatter", "bvh_emit_regions"}) {
    CHECK(kernels.count(name) == 1);
  }
}

TEST_CASE("render --dump-kernels writes the flattened sources") {
  const Renders renders;
  const TempFolder dump;
  static_cast<void>(renders.run(renders.glass, "a.exr", {"--spp", "1", "--dump-kernels", dump.path().string()}));
  CHECK(listing(dump.path()).size() >= 3);
  bool has_stages = false;
  // The C++ branch of the shared headers keeps its <cstdint>, which OpenCL never sees.
  const std::regex include("(^|\n)[ \t]*#[ \t]*include[ \t]*\"");
  for (const std::string& name : listing(dump.path())) {
    CAPTURE(name);
    CHECK(fs::path(name).extension() == ".cl");
    const std::string source = read_whole_file(dump / name);
    CHECK_FALSE(std::regex_search(source, include));
    CHECK_THAT(source, Catch::Contains("#line 1 \""));
    CHECK_THAT(source, Catch::Contains("__kernel") || Catch::Contains("kernel void"));
    has_stages = has_stages || source.find("path_queue_count") != std::string::npos;
  }
  CHECK(has_stages);
}

TEST_CASE("render options change what they say they change") {
  const Renders renders;
  const Image four = renders.image(renders.glass, "a.exr", {"--size", "12x8", "--spp", "4"});
  CHECK(four.width == 12);
  CHECK(four.height == 8);
  CHECK(renders.image(renders.glass, "b.exr", {"--size", "12x8", "--spp", "9"}).metadata["samples"] == "9");
  CHECK(brightest(renders.image(renders.glass, "b.exr", {"--depth", "0"}), "refraction") == 0.0F);
  const Image mega = renders.image(renders.glass, "b.exr", {"--size", "12x8", "--engine", "megakernel", "--strict"});
  const Image wave = renders.image(renders.glass, "c.exr", {"--size", "12x8", "--engine", "wavefront", "--strict"});
  CHECK(same_bits(mega, wave));
  // What the megakernel does anyway, and what every bvh can have, is no mistake.
  CHECK(stage_names(renders.statistics(renders.glass, {"--engine", "megakernel", "--rays", "single"}))
            .count("path_megakernel") == 1);
  static_cast<void>(renders.statistics(renders.glass, {"--accel", "bvh2", "--tree", "fast"}));
  CHECK(stage_names(renders.statistics(renders.glass, {"--engine", "wavefront"})).count("path_megakernel") == 0);
}

TEST_CASE("the same seed gives the same bits, another one others") {
  const Renders renders;
  const Image a = renders.image(renders.glass, "a.exr", {"--seed", "1"});
  CHECK(same_bits(a, renders.image(renders.glass, "b.exr", {"--seed", "1"})));
  CHECK_FALSE(same_bits(a, renders.image(renders.glass, "b.exr", {"--seed", "2"})));
  CHECK_FALSE(same_bits(a, renders.image(renders.glass, "b.exr", {"--seed", "4294967295"})));
}

TEST_CASE("render replaces an older picture whole") {
  const Renders renders;
  const std::string output = renders.folder.write("a.exr", std::string(1 << 20, 'x')).string();
  CHECK(renders.image(renders.matte, "a.exr", {"--spp", "1"}).width == 24);
  CHECK(fs::file_size(output) < 1 << 20);
  CHECK(listing(renders.folder.path()) == std::set<std::string>{"a.exr", "glass.json", "matte.json"});
}
