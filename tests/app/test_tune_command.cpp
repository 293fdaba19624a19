// `hemiray tune` as a user runs it, on a small room and one number.
#include <catch2/catch.hpp>
#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/app/small_scenes.hpp"
#include "tests/support/run_program.hpp"
#include "tests/support/temp_folder.hpp"

using hemiray::test::listing;
using hemiray::test::ProgramResult;
using hemiray::test::run_program;
using hemiray::test::TempFolder;
using nlohmann::json;

namespace {

std::vector<std::string> small(const std::string& output, const std::string& only) {
  return {"tune", "-o", output, "--triangles", "10000", "--resolution", "32", "--only", only};
}

}  // namespace

TEST_CASE("tune measures a number and writes a profile that HEMIRAY_PROFILE takes") {
  const TempFolder folder;
  const std::string file = (folder / "profile.json").string();
  const ProgramResult result = run_program(small(file, "rays_per_item"));
  INFO(result.out << result.err);
  REQUIRE(result.exit_code == 0);
  CHECK(result.err.empty());
  CHECK_THAT(result.out, Catch::Contains("rays_per_item") && Catch::Contains(" ms  *") &&
                             Catch::Contains("HEMIRAY_PROFILE=" + file) && !Catch::Contains("max_leaf"));
  std::ifstream stream(file);
  const json profile = json::parse(stream)["profiles"][0];
  CHECK_FALSE(profile["device"].get<std::string>().empty());
  CHECK(profile["rays_per_item"].get<int>() >= 1);
  CHECK(profile.contains("sort_groups"));

  const std::string scene = folder.write("scene.json", hemiray::test::kMatteScene).string();
  const ProgramResult rendered =
      run_program({"render", scene, "-o", (folder / "a.exr").string()}, {{"HEMIRAY_PROFILE", file}});
  INFO(rendered.err);
  CHECK(rendered.exit_code == 0);
}

TEST_CASE("tune refuses numbers that are none and files that cannot be written, and writes nothing") {
  const TempFolder folder;
  const ProgramResult unknown = run_program(small((folder / "p.json").string(), "max_leaves"));
  CHECK(unknown.exit_code == 2);
  CHECK_THAT(unknown.err, Catch::Contains("--only") && Catch::Contains("did you mean \"max_leaf\""));
  const ProgramResult nowhere = run_program(small((folder / "no" / "p.json").string(), "max_leaf"));
  CHECK(nowhere.exit_code == 2);
  CHECK_THAT(nowhere.err, Catch::Contains("p.json"));
  std::vector<std::string> words = small((folder / "p.json").string(), "max_leaf");
  words.insert(words.end(), {"--device", "split:2"});
  const ProgramResult several = run_program(words);
  CHECK(several.exit_code == 2);
  CHECK_THAT(several.err, Catch::Contains("--device: 'split:2'") && Catch::Contains("tune measures one device"));
  CHECK(listing(folder.path()).empty());
}
