// `hemiray compare` as a user or a CI job runs it: numbers, files, exit codes.
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "host/base/exr.hpp"
#include "tests/support/run_program.hpp"
#include "tests/support/temp_folder.hpp"

using hemiray::Image;
using hemiray::read_exr;
using hemiray::write_exr;
using hemiray::test::ProgramResult;
using hemiray::test::run_program;
using hemiray::test::TempFolder;
namespace fs = std::filesystem;

namespace {

/// a.exr differs from b.exr in one value of the beauty layer and one of depth.
struct TwoImages {
  TempFolder folder;
  std::string a = (folder / "a.exr").string();
  std::string b = (folder / "b.exr").string();
  Image image_b;

  TwoImages() {
    image_b.width = 4;
    image_b.height = 2;
    image_b.layers = {{"", {"R", "G", "B"}, std::vector<float>(24, 1.0F)},
                      {"depth", {"Z"}, std::vector<float>(8, 2.0F)}};
    write_exr(b, image_b);
    Image image_a = image_b;
    image_a.layers[0].data[3 * 5 + 1] = 1.5F;  // pixel (1, 1), G
    image_a.layers[1].data[3] = 2.25F;         // pixel (3, 0)
    write_exr(a, image_a);
  }
};

// An error is one line on stderr, nothing on stdout, exit code 2.
void check_input_error(const ProgramResult& result, const std::string& part) {
  INFO("stdout: " << result.out << "\nstderr: " << result.err);
  CHECK(result.exit_code == 2);
  CHECK(result.out.empty());
  CHECK_THAT(result.err, Catch::Contains(part));
  CHECK(std::count(result.err.begin(), result.err.end(), '\n') == 1);
}

}  // namespace

TEST_CASE("compare prints the numbers and writes a difference image beside A") {
  const TwoImages images;
  const ProgramResult result = run_program({"compare", images.a, images.b});
  INFO(result.out << result.err);
  CHECK(result.exit_code == 0);
  CHECK(result.err.empty());
  // rmse = sqrt(0.25 / 24), relMSE = 0.25 / 1.01 / 24, PSNR = -20 log10(rmse)
  CHECK_THAT(result.out, Catch::Contains("0.102062") && Catch::Contains("0.0103135") && Catch::Contains("19.82") &&
                             Catch::Contains("0.5"));
  CHECK_THAT(result.out, Catch::Contains("first difference: pixel (3, 0), layer depth, channel Z: 2.25 against 2"));
  CHECK_THAT(result.out, Catch::Contains((images.folder / "a.diff.png").string()));
  CHECK(hemiray::test::read_whole_file(images.folder / "a.diff.png").starts_with("\x89PNG"));
}

TEST_CASE("compare --json is JSON with the same numbers") {
  const TwoImages images;
  const ProgramResult result =
      run_program({"compare", images.a, images.b, "--json", "--no-difference", "--tolerance", "max=0.1"});
  CHECK(result.exit_code == 3);
  const auto json = nlohmann::json::parse(result.out);
  CHECK(json["identical"] == false);
  CHECK(json["within"] == false);
  CHECK(json["tolerances"][0]["tolerance"] == "max=0.1");
  CHECK(json["layers"][0]["rmse"].get<double>() == Approx(std::sqrt(0.25 / 24)));
  CHECK(json["layers"][1]["max_abs"] == 0.25);
  CHECK(json["first_difference"]["x"] == 3);
  CHECK(json["difference_image"].is_null());
  CHECK_FALSE(fs::exists(images.folder / "a.diff.png"));
  const auto same = nlohmann::json::parse(run_program({"compare", images.a, images.a, "--json"}).out);
  CHECK(same["layers"][0]["psnr_db"].is_null());
  CHECK(same["first_difference"].is_null());
}

TEST_CASE("compare of identical images says so and writes nothing") {
  const TwoImages images;
  const ProgramResult result = run_program({"compare", images.b, images.b, "--tolerance", "identical"});
  CHECK(result.exit_code == 0);
  CHECK_THAT(result.out, Catch::Contains("identical: every bit"));
  CHECK_FALSE(fs::exists(images.folder / "b.diff.png"));
}

TEST_CASE("compare --tolerance is the verdict") {
  const TwoImages images;
  const auto verdict = [&](const std::vector<std::string>& options) {
    std::vector<std::string> arguments{"compare", images.a, images.b, "--no-difference"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    return run_program(arguments).exit_code;
  };
  CHECK(verdict({"--tolerance", "relmse=0.0104"}) == 0);
  CHECK(verdict({"--tolerance", "relmse=0.0103"}) == 3);
  CHECK(verdict({"--tolerance", "rmse=0.1021"}) == 0);
  CHECK(verdict({"--tolerance", "rmse=0.102"}) == 3);
  CHECK(verdict({"--tolerance", "max=0.5"}) == 0);
  CHECK(verdict({"--tolerance", "max=0.49"}) == 3);
  CHECK(verdict({"--tolerance", "psnr=19.8"}) == 0);
  CHECK(verdict({"--tolerance", "psnr=19.9"}) == 3);
  CHECK(verdict({"--tolerance", "identical"}) == 3);
  CHECK(verdict({"--tolerance", "max=0.5,relmse=0.0103"}) == 3);
  CHECK(verdict({"--tolerance", "max=0.5", "--tolerance", "relmse=0.0104"}) == 0);
  CHECK(verdict({"--tolerance", "max=0.25", "--layer", "depth"}) == 0);
  CHECK(verdict({"--tolerance", "max=0.24", "--layer", "depth"}) == 3);
  // Options before the images do not swallow them.
  CHECK(run_program({"compare", "--tolerance", "max=0.5", images.a, images.b, "--no-difference"}).exit_code == 0);
}

TEST_CASE("compare --tolerance identical looks at every layer, with --layer at that one") {
  const TwoImages images;
  Image c = images.image_b;
  c.layers[1].data[0] = 3;
  const std::string path = (images.folder / "c.exr").string();
  write_exr(path, c);
  CHECK(run_program({"compare", path, images.b, "--tolerance", "identical", "--no-difference"}).exit_code == 3);
  CHECK(run_program({"compare", path, images.b, "--tolerance", "max=0", "--no-difference"}).exit_code == 0);
  c.layers[1].data[0] = 2;
  c.layers[0].data[0] = 7;
  write_exr(path, c);
  CHECK(run_program({"compare", path, images.b, "--layer", "depth", "--tolerance", "identical", "--no-difference"})
            .exit_code == 0);
}

TEST_CASE("compare --difference writes where it is told") {
  const TwoImages images;
  const std::string exr = (images.folder / "difference.exr").string();
  CHECK(run_program({"compare", images.a, images.b, "--difference", exr}).exit_code == 0);
  const Image difference = read_exr(exr);
  CHECK(difference.find("")->data[3 * 5 + 1] == 0.5F);
  CHECK(difference.find("depth")->data[3] == 0.25F);
  CHECK_FALSE(fs::exists(images.folder / "a.diff.png"));

  const std::string before = hemiray::test::read_whole_file(images.a);
  check_input_error(run_program({"compare", images.a, images.b, "--difference", images.a}), "would overwrite");
  CHECK(hemiray::test::read_whole_file(images.a) == before);
  check_input_error(run_program({"compare", images.a, images.b, "--difference", (images.folder / "d.jpg").string()}),
                    "must end in .exr or .png");
  check_input_error(
      run_program({"compare", images.a, images.b, "--difference", (images.folder / "no" / "d.png").string()}),
      "does not exist");
}

TEST_CASE("compare refuses what cannot be compared") {
  const TwoImages images;
  const std::string other = (images.folder / "other.exr").string();
  check_input_error(run_program({"compare", images.a, other}), "no such file");
  images.folder.write("other.exr", "not an image");
  check_input_error(run_program({"compare", images.a, other}), "not an OpenEXR file");

  Image image = images.image_b;
  image.width = 2;
  image.height = 4;
  write_exr(other, image);
  check_input_error(run_program({"compare", images.a, other}), "is 4 x 2");
  image = images.image_b;
  image.layers.pop_back();
  write_exr(other, image);
  check_input_error(run_program({"compare", images.a, other}), "lacks layer \"depth\"");
  image = images.image_b;
  image.layers[0].data[4] = std::numeric_limits<float>::quiet_NaN();
  write_exr(other, image);
  check_input_error(run_program({"compare", images.a, other}), "NaN at pixel (1, 0), channel G");
  CHECK_FALSE(fs::exists(images.folder / "a.diff.png"));
}

TEST_CASE("compare refuses tolerances it does not understand before it writes anything") {
  const TwoImages images;
  for (const std::string text :
       {"relmse", "relmse=", "relmse=abc", "relmse=nan", "relmse=-1", "rms=1", "relmse=1e-3x"}) {
    check_input_error(run_program({"compare", images.a, images.b, "--tolerance", text}), "--tolerance");
  }
  check_input_error(run_program({"compare", images.a, images.b, "--layer", "albedo"}), "has no layer \"albedo\"");
  CHECK_FALSE(fs::exists(images.folder / "a.diff.png"));
}

TEST_CASE("compare --help shows the options and examples") {
  const ProgramResult result = run_program({"compare", "--help"});
  CHECK(result.exit_code == 0);
  CHECK_THAT(result.out,
             Catch::Contains("--tolerance") && Catch::Contains("Examples:") && Catch::Contains("Exit code"));
}
