// Ctrl-C during a render, and the progress bar on a terminal (by which these tests know that the render is under way).
#include <catch2/catch.hpp>
#include <csignal>

#include <unistd.h>

#include "host/base/exr.hpp"
#include "tests/app/small_scenes.hpp"
#include "tests/support/running_program.hpp"
#include "tests/support/temp_folder.hpp"

using namespace hemiray;
using namespace hemiray::test;

namespace {

/// A render that would take hours, on a terminal, under way when the constructor returns.
struct LongRender {
  TempFolder folder;
  std::string scene;
  std::string output = (folder / "a.exr").string();
  RunningProgram program;

  explicit LongRender(const std::string& size, const std::string& spp = "1000000",
                      const std::string& scene_text = kMatteScene)
      : scene(folder.write("scene.json", scene_text).string()),
        program({{"render", scene, "-o", output, "--size", size, "--spp", spp}, {}, true, 0, "/dev/null"}) {
    program.wait_for("render [");
  }
};

}  // namespace

TEST_CASE("an interrupt ends the pass, writes what is there and exits with 130") {
  for (const int signal_number : {SIGINT, SIGTERM}) {
    CAPTURE(signal_number);
    LongRender render("64x48");
    render.program.send(signal_number);
    const ProgramEnd end = render.program.wait();
    INFO(end.err);
    CHECK_FALSE(end.by_signal);
    CHECK(end.number == 130);
    CHECK_THAT(end.err, Catch::Contains("hemiray: interrupted after ") && Catch::Contains(" of 1000000 samples") &&
                            Catch::Contains("wrote " + render.output));
    Image image = read_exr(render.output);
    CHECK(image.width == 64);
    CHECK(has_no_nan(image));
    CHECK(brightest(image, "") > 0.0F);
    const int samples = std::stoi(image.metadata["samples"]);
    CHECK(samples >= 1);
    CHECK(samples < 1000000);
    CHECK_THAT(end.err, Catch::Contains("after " + std::to_string(samples) + " of"));
    // Divided by the passes made, not by those asked for: the floor is as bright as in a whole picture.
    CHECK(brightest(image, "") > 0.1F);
    CHECK(listing(render.folder.path()) == std::set<std::string>{"a.exr", "scene.json"});
  }
}

TEST_CASE("a second interrupt kills at once and leaves nothing behind") {
  LongRender render("2048x1536");  // a pass takes seconds
  render.program.send(SIGINT);
  usleep(50'000);
  render.program.send(SIGINT);
  const ProgramEnd end = render.program.wait();
  INFO(end.err);
  CHECK(end.by_signal);
  CHECK(end.number == SIGINT);
  CHECK(end.err.find("interrupted") == std::string::npos);
  CHECK(listing(render.folder.path()) == std::set<std::string>{"scene.json"});
}

TEST_CASE("the progress bar on a terminal shows rate and time left and is wiped") {
  LongRender render("64x48");
  render.program.wait_for("rays/s");
  render.program.wait_for(" left");
  render.program.send(SIGINT);
  const std::string text = render.program.wait().err;
  const std::size_t wiped = text.rfind(std::string(20, ' ') + "\r");
  REQUIRE(wiped != std::string::npos);
  CHECK(wiped < text.find("hemiray: interrupted"));
}

TEST_CASE("interrupted view factors write nothing and say why") {
  const TempFolder folder;
  RunningProgram program({{"view-factors", HR_SOURCE_DIR "/scenes/cornell_box.json", "-o", (folder / "F.csv").string(),
                           "--patches", "4000"},
                          {},
                          true,
                          0,
                          "/dev/null"});
  program.wait_for("view factors [");
  program.send(SIGINT);
  const ProgramEnd end = program.wait();
  INFO(end.err);
  CHECK_FALSE(end.by_signal);
  CHECK(end.number == 130);
  CHECK_THAT(end.err, Catch::Contains("hemiray: interrupted: no factor between areas was computed whole") &&
                          Catch::Contains("nothing is written"));
  CHECK(listing(folder.path()).empty());
}

TEST_CASE("an interrupt in the only pass is not forgotten") {
  // So many lights that the pass takes seconds: there is no progress to see in the first one.
  std::string text = kMatteScene;
  const std::string light = R"({ "type": "point", "position": [0.5, 2, 0.5], "intensity": [9, 9, 9] })";
  const std::size_t at = text.find(light);
  REQUIRE(at != std::string::npos);
  for (int i = 0; i < 63; i++) text.insert(at, light + ", ");
  LongRender render("2500x2500", "1", text);
  render.program.send(SIGINT);
  const ProgramEnd end = render.program.wait();
  INFO(end.err);
  CHECK_FALSE(end.by_signal);
  CHECK(end.number == 130);
  CHECK_THAT(end.err, Catch::Contains("interrupted after 1 of 1 samples"));
}
