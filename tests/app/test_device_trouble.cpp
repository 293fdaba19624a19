// What is not the user's fault: memory, compilers, caches, disks. Exit code 1 where the render cannot go on.
#include <catch2/catch.hpp>
#include <fstream>
#include <regex>

#include "host/base/exr.hpp"
#include "tests/app/small_scenes.hpp"
#include "tests/support/run_program.hpp"
#include "tests/support/running_program.hpp"
#include "tests/support/temp_folder.hpp"

using namespace hemiray;
using namespace hemiray::test;
namespace fs = std::filesystem;

namespace {

struct Scene {
  TempFolder folder;
  std::string file = folder.write("scene.json", kMatteScene).string();
  std::string output = (folder / "a.exr").string();
};

const std::set<std::string> kNothingWritten{"scene.json"};

}  // namespace

TEST_CASE("a picture larger than the device's memory says what it needs and what there is") {
  const Scene scene;
  const ProgramResult result =
      run_program({"render", scene.file, "-o", scene.output, "--size", "32768x32768", "--spp", "1"});
  INFO(result.err);
  CHECK(result.exit_code == 1);
  CHECK(result.out.empty());
  CHECK(std::count(result.err.begin(), result.err.end(), '\n') == 1);
  CHECK(std::regex_search(result.err, std::regex("needs (about )?[0-9.]+ [GT]iB.*(has|allows) [0-9.]+ [GT]iB")));
  CHECK(listing(scene.folder.path()) == kNothingWritten);
}

TEST_CASE("a kernel that does not compile is named by file and line") {
  const Scene scene;
  const TempFolder kernels;
  const TempFolder cache;
  kernels.write("path/queue.cl", "// broken on purpose\nint a b;\nint c d;\n");
  const ProgramResult result =
      run_program({"render", scene.file, "-o", scene.output, "--spp", "1"},
                  {{"HEMIRAY_KERNEL_DIR", kernels.path().string()}, {"HEMIRAY_CACHE_DIR", cache.path().string()}});
  INFO(result.err);
  CHECK(result.exit_code == 1);
  CHECK(result.out.empty());
  // The compiler inside PoCL counts its errors on stderr by itself; hemiray's own word is one line.
  const std::string ours = std::regex_replace(result.err, std::regex("[0-9]+ errors? generated\\.\n"), "");
  CHECK(std::count(ours.begin(), ours.end(), '\n') == 1);
  CHECK_THAT(ours, Catch::StartsWith("hemiray: compiling kernels 'wavefront'") && Catch::Contains("path/queue.cl:2:") &&
                       Catch::Contains("CL_BUILD_PROGRAM_FAILURE"));
  CHECK_THAT(ours, Catch::Contains("the whole log is in " + (cache / "wavefront_build.log").string()));
  CHECK_THAT(read_whole_file(cache / "wavefront_build.log"),
             Catch::Contains("path/queue.cl:2:") && Catch::Contains("path/queue.cl:3:"));
  CHECK(listing(scene.folder.path()) == kNothingWritten);
}

TEST_CASE("HEMIRAY_KERNEL_DIR replaces a kernel file by another") {
  // Every path ends where it starts: a black picture, hence the file was used.
  const Scene scene;
  const TempFolder kernels;
  std::string source = read_whole_file(HR_SOURCE_DIR "/kernels/path/shade_surface.h");
  const std::size_t name = source.find("stage_shade_surface(");
  REQUIRE(name != std::string::npos);
  const std::size_t body = source.find('{', name);
  source.insert(body + 1, "\n  if (1) return HR_STAGE_done;\n");
  kernels.write("path/shade_surface.h", source);
  const std::vector<std::string> arguments{"render", scene.file, "-o", scene.output, "--spp", "1", "--quiet"};
  CHECK(run_program(arguments).exit_code == 0);
  CHECK(brightest(read_exr(scene.output), "") > 0.0F);
  const ProgramResult result = run_program(arguments, {{"HEMIRAY_KERNEL_DIR", kernels.path().string()}});
  INFO(result.err);
  CHECK(result.exit_code == 0);
  CHECK(brightest(read_exr(scene.output), "") == 0.0F);
}

TEST_CASE("a cache that cannot be written or holds garbage changes nothing but the time") {
  const Scene scene;
  const TempFolder cache;
  const std::vector<std::string> arguments{"render", scene.file, "-o", scene.output, "--spp", "1"};
  const auto picture_with = [&](const std::string& folder) {
    fs::remove(scene.output);
    const ProgramResult result = run_program(arguments, {{"HEMIRAY_CACHE_DIR", folder}});
    INFO(folder << ": " << result.err);
    CHECK(result.exit_code == 0);
    CHECK(result.err.empty());
    return read_exr(scene.output).find("")->data;
  };
  const std::vector<float> expected = picture_with(cache.path().string());
  CHECK(picture_with(cache.write("a_file", "").string()) == expected);
  CHECK(picture_with("/proc/no-folder-can-be-made-here") == expected);
  CHECK(picture_with("") == expected);
  // Cut, emptied and overwritten entries; where the driver keeps the cache there are none of our own.
  int spoiled = 0;
  for (const auto& entry : fs::directory_iterator(cache.path())) {
    if (entry.path().extension() != ".bin") continue;
    const std::string content = read_whole_file(entry.path());
    const std::vector<std::string> garbage{content.substr(0, content.size() / 2), "", std::string(4096, '\x5a')};
    std::ofstream(entry.path(), std::ios::binary) << garbage[static_cast<std::size_t>(spoiled++ % 3)];
  }
  CHECK(picture_with(cache.path().string()) == expected);
}

TEST_CASE("a full disk is an error that leaves nothing half-written") {
  const Scene scene;
  const std::vector<std::string> arguments{"render",   scene.file, "-o", scene.output, "--size",
                                           "1024x768", "--spp",    "1",  "--quiet"};
  // Compiles the kernels, whose cache has no room under the limit.
  REQUIRE(run_program(arguments).exit_code == 0);
  const std::string whole = read_whole_file(scene.output);
  constexpr std::uint64_t kLimit = 3U << 19U;  // [bytes]: PoCL's preprocessor writes 1.05 million
  REQUIRE(whole.size() > kLimit);
  const auto run_limited = [&] { return RunningProgram({arguments, {}, false, kLimit, "/dev/null"}).wait(); };
  ProgramEnd end = run_limited();
  INFO(end.err);
  CHECK_FALSE(end.by_signal);
  CHECK(end.number == 1);
  CHECK_THAT(end.err, Catch::StartsWith("hemiray: " + scene.output + ": ") && Catch::Contains("free some space"));
  CHECK(std::count(end.err.begin(), end.err.end(), '\n') == 1);
  // The older picture is as it was, and no temporary is left.
  CHECK(read_whole_file(scene.output) == whole);
  CHECK(listing(scene.folder.path()) == std::set<std::string>{"a.exr", "scene.json"});
  fs::remove(scene.output);
  end = run_limited();
  CHECK(end.number == 1);
  CHECK(listing(scene.folder.path()) == kNothingWritten);
}

TEST_CASE("statistics that cannot be printed are an error") {
  if (!fs::exists("/dev/full")) {
    WARN("no /dev/full: not tested");
    return;
  }
  const Scene scene;
  for (const std::vector<std::string>& arguments : {std::vector<std::string>{"devices"},
                                                    {"devices", "--json"},
                                                    {"check", scene.file},
                                                    {"render", scene.file, "-o", scene.output, "--spp", "1", "--json"},
                                                    {"render", scene.file, "-o", scene.output, "--spp", "1"}}) {
    const ProgramEnd end = RunningProgram({arguments, {}, false, 0, "/dev/full"}).wait();
    CAPTURE(arguments[0], end.err);
    CHECK(end.number == 1);
    CHECK_THAT(end.err, Catch::StartsWith("hemiray: stdout: "));
    CHECK(std::count(end.err.begin(), end.err.end(), '\n') == 1);
  }
}
