// Every scene that is shipped, and every model made elsewhere that is at hand, renders to a picture.
#include <catch2/catch.hpp>
#include <cstdlib>

#include "host/base/exr.hpp"
#include "tests/app/small_scenes.hpp"
#include "tests/support/run_program.hpp"
#include "tests/support/temp_folder.hpp"

using namespace hemiray;
using namespace hemiray::test;
namespace fs = std::filesystem;

namespace {

fs::path data_folder() {
  const char* chosen = std::getenv("HEMIRAY_TEST_DATA");
  return chosen != nullptr ? fs::path(chosen) : fs::path(HR_SOURCE_DIR) / "../shared/data";
}

bool is_scene(const fs::path& file) {
  const std::set<std::string> kinds{".json", ".gltf", ".glb", ".obj", ".ply"};
  return kinds.count(file.extension().string()) == 1 && file.filename() != "scene.schema.json";
}

/// Renders every scene in `folder` and below at 64x64 with one sample; returns how many.
int render_all(const fs::path& folder) {
  const TempFolder temporary;
  const std::string output = (temporary / "a.exr").string();
  int rendered = 0;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (!entry.is_regular_file() || !is_scene(entry.path())) continue;
    CAPTURE(entry.path().string());
    fs::remove(output);
    const ProgramResult result =
        run_program({"render", entry.path().string(), "-o", output, "--size", "64x64", "--spp", "1", "--quiet"});
    INFO(result.err);
    CHECK(result.exit_code == 0);
    if (!fs::exists(output)) continue;
    const Image image = read_exr(output);
    CHECK(image.width == 64);
    CHECK(image.height == 64);
    CHECK(has_no_nan(image));
    CHECK(brightest(image, "") > 0.0F);
    CHECK(brightest(image, "depth") > 0.0F);
    ++rendered;
  }
  return rendered;
}

void render_models(const std::string& subfolder) {
  const fs::path folder = data_folder() / subfolder;
  if (!fs::is_directory(folder)) {
    WARN("no folder " << folder.string() << ": its models are not rendered; set HEMIRAY_TEST_DATA to one that has it");
    return;
  }
  CHECK(render_all(folder) > 0);
}

}  // namespace

TEST_CASE("every shipped scene renders") { CHECK(render_all(fs::path(HR_SOURCE_DIR) / "scenes") >= 8); }

TEST_CASE("every real model renders: meshes") { render_models("meshes"); }

TEST_CASE("every real model renders: glTF") { render_models("gltf"); }

TEST_CASE("every real model renders: Cornell boxes") { render_models("cornell"); }
