// sRGB encoding against the standard's formula worked by hand, and PNG files read back by the decoder.
#include "host/base/png.hpp"

#include <catch2/catch.hpp>
#include <limits>

#include "host/base/error.hpp"
#include "host/base/image_decode.hpp"
#include "tests/support/temp_folder.hpp"

using hemiray::Image;
using hemiray::to_srgb8;
using hemiray::test::TempFolder;

namespace {

std::vector<std::uint8_t> decoded(const Image& image, const std::string& layer, double exposure_stops) {
  return hemiray::decode_image(hemiray::encode_png(image, layer, exposure_stops), "encoded.png").rgba;
}

}  // namespace

TEST_CASE("sRGB: known values, clamping, NaN") {
  CHECK(to_srgb8(0.0F) == 0);
  CHECK(to_srgb8(1.0F) == 255);
  CHECK(to_srgb8(0.5F) == 188);        // 1.055 * 0.5^(1/2.4) - 0.055 = 0.73536
  CHECK(to_srgb8(0.18F) == 118);       // middle grey: 0.46136
  CHECK(to_srgb8(0.0031308F) == 10);   // the knee: 0.04045
  CHECK(to_srgb8(0.001F) == 3);        // linear part: 0.01292
  CHECK(to_srgb8(0.2140411F) == 127);  // 0.49999, just under one half
  CHECK(to_srgb8(-1.0F) == 0);
  CHECK(to_srgb8(7.0F) == 255);
  CHECK(to_srgb8(std::numeric_limits<float>::infinity()) == 255);
  CHECK(to_srgb8(-std::numeric_limits<float>::infinity()) == 0);
  CHECK(to_srgb8(std::numeric_limits<float>::quiet_NaN()) == 0);
}

TEST_CASE("PNG: exposure in stops, rows from the top, channels by name") {
  Image image;
  image.width = 2;
  image.height = 2;
  image.layers = {{"", {"A", "B", "G", "R"}, {1, 0.25F, 0.5F, 1, 1, 0, 0, 0, 1, 0, 1, 0, 0, 2, 0, 0}}};
  CHECK(decoded(image, "", 0) ==
        std::vector<std::uint8_t>{255, 188, 137, 255, 0, 0, 0, 255, 0, 255, 0, 255, 0, 0, 255, 255});
  CHECK(decoded(image, "", -1) ==
        std::vector<std::uint8_t>{188, 137, 99, 255, 0, 0, 0, 255, 0, 188, 0, 255, 0, 0, 255, 255});
}

TEST_CASE("PNG: normals as X, Y, Z, single channels as grey, unknown layers refused") {
  Image image;
  image.width = 1;
  image.height = 1;
  image.layers = {{"normal", {"X", "Y", "Z"}, {-1, 0.5F, 1}}, {"depth", {"Z"}, {0.5F}}};
  CHECK(decoded(image, "normal", 0) == std::vector<std::uint8_t>{0, 188, 255, 255});
  CHECK(decoded(image, "depth", 0) == std::vector<std::uint8_t>{188, 188, 188, 255});
  CHECK_THROWS_WITH(hemiray::encode_png(image, "", 0), Catch::Contains("\"normal\", \"depth\""));
}

TEST_CASE("PNG: the file is written and is what encode_png gives") {
  const TempFolder folder;
  Image image;
  image.width = 3;
  image.height = 1;
  image.layers = {{"", {"R", "G", "B"}, {0, 0, 0, 1, 1, 1, 0.5F, 0.5F, 0.5F}}};
  hemiray::write_png(folder / "image.png", image);
  const std::string file = hemiray::test::read_whole_file(folder / "image.png");
  const auto bytes = hemiray::encode_png(image, "", 0);
  CHECK(file == std::string(bytes.begin(), bytes.end()));
}
