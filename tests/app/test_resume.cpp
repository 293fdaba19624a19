// Solutions that are killed and go on, as a user does it; and files of them that are not what they should be.
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <sys/stat.h>
#include <unistd.h>
#include <csignal>

#include "host/base/exr.hpp"
#include "tests/app/small_scenes.hpp"
#include "tests/support/run_program.hpp"
#include "tests/support/running_program.hpp"
#include "tests/support/temp_folder.hpp"

using namespace hemiray;
using namespace hemiray::test;

namespace {

using Words = std::vector<std::string>;

const std::string kCornellBox = HR_SOURCE_DIR "/scenes/cornell_box.json";

Words operator+(Words a, const Words& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

// Enough iterations and batches of rows that there are moments of all kinds.
Words solve_words(const std::string& glb, const std::string& solver = "jacobi") {
  return {"solve",        kCornellBox, "-o",       glb,    "--patches",   "900",  "--form-factors", "hemicube",
          "--resolution", "64",        "--solver", solver, "--tolerance", "1e-7", "--quiet"};
}

Words saved_in(const std::string& file) { return {"--save", file, "--save-every", "0"}; }
Words resumed_from(const std::string& file) { return {"--resume", file, "--save-every", "0"}; }

// Until the file was written for the nth time; every time it is another one. False: that did not happen in time.
bool wait_for_write(const std::string& file, int times) {
  ino_t last = 0;
  constexpr int kPolls = 300'000;
  for (int poll = 0; poll < kPolls; poll++) {
    struct stat status {};
    if (stat(file.c_str(), &status) == 0 && status.st_ino != last) {
      last = status.st_ino;
      if (--times == 0) return true;
    }
    usleep(100);
  }
  return false;
}

// Without temporaries that kills left: they are hidden, and no one's.
std::set<std::string> visible(const std::filesystem::path& folder) {
  std::set<std::string> names = listing(folder);
  std::erase_if(names, [](const std::string& name) { return name.starts_with('.'); });
  return names;
}

}  // namespace

TEST_CASE("solve that is killed at any moment goes on and ends with the same bits") {
  const TempFolder folder;
  const std::string whole = (folder / "whole.glb").string(), glb = (folder / "a.glb").string(),
                    file = (folder / "a.solution").string();
  REQUIRE(run_program(solve_words(whole)).exit_code == 0);
  const std::string expected = read_whole_file(whole);
  int kills = 0;
  for (const int writes : {1, 2, 3, 4}) {
    CAPTURE(writes);
    std::filesystem::remove(file);
    std::filesystem::remove(glb);
    {
      RunningProgram program({solve_words(glb) + saved_in(file), {}, false, 0, "/dev/null"});
      REQUIRE(wait_for_write(file, writes));
      program.send(SIGKILL);
      const ProgramEnd end = program.wait();
      kills += end.by_signal ? 1 : 0;
      CHECK(std::filesystem::exists(glb) != end.by_signal);
    }
    // Again while it goes on: the file is never without a state.
    {
      RunningProgram program({solve_words(glb) + resumed_from(file), {}, false, 0, "/dev/null"});
      usleep(static_cast<useconds_t>(100'000 * writes));
      program.send(SIGKILL);
      kills += program.wait().by_signal ? 1 : 0;
    }
    const ProgramResult rest = run_program(solve_words(glb) + resumed_from(file));
    INFO(rest.err);
    REQUIRE(rest.exit_code == 0);
    CHECK(read_whole_file(glb) == expected);
  }
  CHECK(kills >= 4);
  CHECK(visible(folder.path()) == std::set<std::string>{"whole.glb", "a.glb", "a.solution"});
}

TEST_CASE("an interrupt keeps what was computed and says how to go on") {
  const TempFolder folder;
  const std::string whole = (folder / "whole.glb").string(), glb = (folder / "a.glb").string(),
                    file = (folder / "a.solution").string();
  Words words = solve_words(glb, "southwell");
  words.erase(std::find(words.begin(), words.end(), "--quiet"), words.end());
  Words whole_words = words;
  whole_words[3] = whole;
  REQUIRE(run_program(whole_words).exit_code == 0);
  RunningProgram program({words + Words{"--save", file}, {}, false, 0, "/dev/null"});
  REQUIRE(wait_for_write(file, 1));
  usleep(300'000);
  program.send(SIGINT);
  const ProgramEnd end = program.wait();
  INFO(end.err);
  CHECK_FALSE(end.by_signal);
  REQUIRE(end.number == 130);
  CHECK_THAT(end.err, Catch::Contains("--resume " + file));
  const ProgramResult rest = run_program(words + resumed_from(file));
  INFO(rest.err);
  REQUIRE(rest.exit_code == 0);
  CHECK(read_whole_file(glb) == read_whole_file(whole));
}

TEST_CASE("render shows a finished solution from its file, from another camera, too") {
  const TempFolder folder;
  const std::string glb = (folder / "a.glb").string(), file = (folder / "a.solution").string();
  const auto render = [&](const std::string& exr, const Words& more) {
    const ProgramResult result =
        run_program(Words{"render",         kCornellBox, "-o",           (folder / exr).string(),
                          "--method",       "radiosity", "--patches",    "900",
                          "--form-factors", "hemicube",  "--resolution", "64",
                          "--solver",       "jacobi",    "--tolerance",  "1e-7",
                          "--size",         "24x16",     "--spp",        "1",
                          "--json"} +
                    more);
    INFO(result.err);
    REQUIRE(result.exit_code == 0);
    return nlohmann::json::parse(result.out)["radiosity"];
  };
  REQUIRE(run_program(solve_words(glb) + saved_in(file)).exit_code == 0);
  const auto shown = render("a.exr", {"--resume", file}), solved = render("b.exr", {});
  CHECK(shown["kept_rows"] == solved["rows"]);
  CHECK(shown["rays"] == 0);
  CHECK(solved["kept_rows"] == 0);
  const Image a = read_exr((folder / "a.exr").string()), b = read_exr((folder / "b.exr").string());
  CHECK(a.find("")->data == b.find("")->data);
}

TEST_CASE("a solution file that is damaged, foreign or misplaced is refused, and stays as it is") {
  const TempFolder folder;
  const std::string glb = (folder / "a.glb").string(), file = (folder / "a.solution").string(),
                    bad = (folder / "b.solution").string();
  Words words = solve_words(glb);
  REQUIRE(run_program(words + saved_in(file)).exit_code == 0);
  std::filesystem::remove(glb);
  const std::string good = read_whole_file(file);
  const auto refused = [&](const Words& given, const std::string& said) {
    const std::string before = std::filesystem::exists(bad) ? read_whole_file(bad) : "";
    const ProgramResult result = run_program(given);
    INFO(result.err);
    CHECK(result.exit_code == 2);
    CHECK_THAT(result.err, Catch::Contains(said));
    CHECK(!std::filesystem::exists(glb));
    CHECK(read_whole_file(file) == good);
    if (!before.empty()) CHECK(read_whole_file(bad) == before);
  };
  // Every section: a bit of what follows its name.
  std::size_t sections = 0, at = good.find('\n') + 1;
  while (at < good.size()) {
    std::uint64_t size = 0;
    for (std::size_t i = 8; i-- > 0;) size = size << 8U | static_cast<std::uint8_t>(good[at + 8 + i]);
    const std::string name = good.substr(at, 8);
    std::string damaged = good;
    damaged[at + 16 + size / 2] = static_cast<char>(damaged[at + 16 + size / 2] ^ 4);
    folder.write("b.solution", damaged);
    CAPTURE(name);
    refused(words + Words{"--resume", bad}, "damaged");
    at += 16 + size + 32;
    sections++;
  }
  CHECK(sections >= 6);
  folder.write("b.solution", good.substr(0, good.size() - 1));
  refused(words + Words{"--resume", bad}, "cut short");
  folder.write("b.solution", "hemiray solution 99\n" + good.substr(good.find('\n') + 1));
  refused(words + Words{"--resume", bad}, "version 99");
  folder.write("b.solution", "something else");
  refused(words + Words{"--resume", bad}, "is no solution");
  std::filesystem::remove(bad);
  refused(words + Words{"--resume", bad}, "--save " + bad + " begins one");
  refused(words + saved_in(file), "is there already");
  refused(words + Words{"--save", bad, "--resume", file}, "leave one of the two out");
  refused(words + Words{"--save", glb}, "for something else");
  Words other = words;
  other[5] = "800";
  refused(other + resumed_from(file), "--patches (900 there, 800 now)");
  Words hybrid = solve_words(glb);
  hybrid[7] = "hybrid";
  refused(hybrid + resumed_from(file), R"(--form-factors ("hemicube" there, "hybrid" now))");
  Words scene = words;
  scene[1] = HR_SOURCE_DIR "/scenes/glass_and_mirror.json";
  refused(scene + resumed_from(file), "scene");
  refused({"render", kCornellBox, "-o", (folder / "a.exr").string(), "--resume", file}, "--method radiosity");
}
