// PNG and JPEG decoding: every colour type and depth against values worked out by hand.
#include "host/base/image_decode.hpp"

#include <png.h>

#include <catch2/catch.hpp>
#include <cstdlib>

#include "host/base/error.hpp"
#include "tests/support/image_files.hpp"

using hemiray::decode_image;
using hemiray::DecodedImage;
using hemiray::test::Bytes;
using hemiray::test::JpegSpec;
using hemiray::test::make_jpeg;
using hemiray::test::make_png;
using hemiray::test::PngSpec;

namespace {

// Quality 100 without subsampling: rounding in the colour conversion and in the DCT, both ways.
constexpr int kJpegTolerance = 3;

Bytes decode_png_rows(const PngSpec& spec) { return decode_image(make_png(spec), "test.png").rgba; }

int largest_difference(const Bytes& a, const Bytes& b) {
  REQUIRE(a.size() == b.size());
  int largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i) largest = std::max(largest, std::abs(int{a[i]} - int{b[i]}));
  return largest;
}

Bytes with_alpha(const Bytes& rgb) {
  Bytes rgba;
  for (std::size_t i = 0; i < rgb.size(); ++i) {
    rgba.push_back(rgb[i]);
    if (i % 3 == 2) rgba.push_back(255);
  }
  return rgba;
}

}  // namespace

TEST_CASE("PNG: grey of 1, 2, 4, 8 and 16 bits becomes RGBA") {
  PngSpec spec;
  spec.color_type = PNG_COLOR_TYPE_GRAY;
  spec.width = 2;
  SECTION("1 bit") {
    spec.bit_depth = 1;
    spec.rows = {0b01000000};
    CHECK(decode_png_rows(spec) == Bytes{0, 0, 0, 255, 255, 255, 255, 255});
  }
  SECTION("2 bits") {
    spec.bit_depth = 2;
    spec.rows = {0b01100000};
    CHECK(decode_png_rows(spec) == Bytes{85, 85, 85, 255, 170, 170, 170, 255});
  }
  SECTION("4 bits") {
    spec.bit_depth = 4;
    spec.rows = {0x1f};
    CHECK(decode_png_rows(spec) == Bytes{17, 17, 17, 255, 255, 255, 255, 255});
  }
  SECTION("8 bits") {
    spec.rows = {7, 200};
    CHECK(decode_png_rows(spec) == Bytes{7, 7, 7, 255, 200, 200, 200, 255});
  }
  SECTION("16 bits, rounded and not cut") {
    spec.bit_depth = 16;
    spec.rows = {0x80, 0xff, 0x12, 0x34};  // 33023 / 257 = 128.49, 4660 / 257 = 18.13
    CHECK(decode_png_rows(spec) == Bytes{128, 128, 128, 255, 18, 18, 18, 255});
    spec.rows = {0x00, 0xff, 0x7e, 0xff};  // 255 / 257 = 0.99, 32511 / 257 = 126.50
    CHECK(decode_png_rows(spec) == Bytes{1, 1, 1, 255, 127, 127, 127, 255});
  }
}

TEST_CASE("PNG: alpha from channels, transparent colours and palettes") {
  PngSpec spec;
  spec.width = 2;
  SECTION("grey with alpha") {
    spec.color_type = PNG_COLOR_TYPE_GRAY_ALPHA;
    spec.rows = {10, 20, 30, 40};
    CHECK(decode_png_rows(spec) == Bytes{10, 10, 10, 20, 30, 30, 30, 40});
  }
  SECTION("a transparent grey") {
    spec.color_type = PNG_COLOR_TYPE_GRAY;
    spec.rows = {10, 20};
    spec.transparent_grey = 20;
    CHECK(decode_png_rows(spec) == Bytes{10, 10, 10, 255, 20, 20, 20, 0});
  }
  SECTION("a palette with alpha") {
    spec.color_type = PNG_COLOR_TYPE_PALETTE;
    spec.bit_depth = 2;
    spec.palette = {{1, 2, 3}, {4, 5, 6}, {7, 8, 9}};
    spec.palette_alpha = {50, 60};
    spec.rows = {0b01100000};
    CHECK(decode_png_rows(spec) == Bytes{4, 5, 6, 60, 7, 8, 9, 255});
  }
  SECTION("RGB") {
    spec.color_type = PNG_COLOR_TYPE_RGB;
    spec.rows = {1, 2, 3, 4, 5, 6};
    CHECK(decode_png_rows(spec) == Bytes{1, 2, 3, 255, 4, 5, 6, 255});
  }
  SECTION("RGBA of 16 bits") {
    spec.color_type = PNG_COLOR_TYPE_RGB_ALPHA;
    spec.bit_depth = 16;
    spec.rows = {0, 0, 1, 1, 2, 2, 3, 3, 255, 255, 254, 254, 253, 253, 252, 252};
    CHECK(decode_png_rows(spec) == Bytes{0, 1, 2, 3, 255, 254, 253, 252});
  }
}

TEST_CASE("PNG: interlaced files have the same pixels, rows run top to bottom") {
  PngSpec spec;
  spec.color_type = PNG_COLOR_TYPE_RGB;
  spec.width = 13;
  spec.height = 9;
  spec.rows = hemiray::test::gradient_rgb(13, 9);
  const DecodedImage plain = decode_image(make_png(spec), "plain.png");
  CHECK(plain.width == 13);
  CHECK(plain.height == 9);
  CHECK(plain.rgba == with_alpha(spec.rows));
  spec.interlaced = true;
  CHECK(decode_png_rows(spec) == plain.rgba);
}

TEST_CASE("JPEG: colour, grey, progressive") {
  JpegSpec spec;
  spec.width = 21;
  spec.height = 10;
  spec.samples.assign(21 * 10 * 3, 0);
  for (std::size_t i = 0; i < spec.samples.size(); ++i) {
    spec.samples[i] = static_cast<std::uint8_t>(i % 3 == 0 ? 250 : i % 3 == 1 ? 120 : 10 + i / 21);
  }
  const Bytes expected = with_alpha(spec.samples);
  const DecodedImage image = decode_image(make_jpeg(spec), "test.jpg");
  CHECK(image.width == 21);
  CHECK(image.height == 10);
  CHECK(largest_difference(image.rgba, expected) <= kJpegTolerance);
  spec.progressive = true;
  CHECK(largest_difference(decode_image(make_jpeg(spec), "test.jpg").rgba, expected) <= kJpegTolerance);

  JpegSpec grey;
  grey.components = 1;
  grey.width = 8;
  grey.samples.assign(8, 77);
  const Bytes pixel{77, 77, 77, 255};
  Bytes grey_expected;
  for (int i = 0; i < 8; ++i) grey_expected.insert(grey_expected.end(), pixel.begin(), pixel.end());
  CHECK(largest_difference(decode_image(make_jpeg(grey), "grey.jpg").rgba, grey_expected) <= kJpegTolerance);
}

TEST_CASE("JPEG: CMYK becomes RGB, with Adobe's inverted inks and without") {
  JpegSpec spec;
  spec.components = 4;
  spec.width = 8;
  spec.height = 8;
  // Inks: cyan full, magenta half, no yellow, a fifth of black: R = 0, G = 127 * 204 / 255 = 102, B = 204.
  const Bytes inks{255, 128, 0, 51};
  const Bytes rgba{0, 102, 204, 255};
  Bytes expected;
  for (int i = 0; i < 64; ++i) expected.insert(expected.end(), rgba.begin(), rgba.end());
  spec.adobe_marker = GENERATE(false, true);
  for (std::size_t i = 0; i < 64 * 4; ++i) {
    spec.samples.push_back(spec.adobe_marker ? static_cast<std::uint8_t>(255 - inks[i % 4]) : inks[i % 4]);
  }
  CHECK(largest_difference(decode_image(make_jpeg(spec), "cmyk.jpg").rgba, expected) <= kJpegTolerance);
}
