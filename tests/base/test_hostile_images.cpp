// Broken PNG, JPEG and EXR files: one InputError that names the file, never a crash, never a part of a picture.
#include <png.h>

#include <catch2/catch.hpp>
#include <cstring>
#include <functional>
#include <random>

#include "host/base/error.hpp"
#include "host/base/exr.hpp"
#include "host/base/image_decode.hpp"
#include "tests/support/image_files.hpp"
#include "tests/support/temp_folder.hpp"

using hemiray::decode_exr;
using hemiray::decode_image;
using hemiray::Image;
using hemiray::InputError;
using hemiray::Layer;
using hemiray::test::Bytes;
using hemiray::test::JpegSpec;
using hemiray::test::make_jpeg;
using hemiray::test::make_png;
using hemiray::test::PngSpec;

namespace {

constexpr unsigned kSeed = 20261122;
constexpr int kDamagedCopies = 400;
constexpr std::uint64_t kFewValues = 1U << 20U;  // of EXR files, so that damaged sizes cost no time

using Decoder = std::function<void(const Bytes&)>;

const Decoder decode_texture = [](const Bytes& bytes) { static_cast<void>(decode_image(bytes, "hostile")); };
const Decoder decode_layers = [](const Bytes& bytes) { static_cast<void>(decode_exr(bytes, "hostile", kFewValues)); };

Bytes small_png() {
  PngSpec spec;
  spec.color_type = PNG_COLOR_TYPE_RGB;
  spec.width = 17;
  spec.height = 11;
  spec.rows = hemiray::test::gradient_rgb(17, 11);
  return make_png(spec);
}

Bytes small_jpeg(bool progressive) {
  JpegSpec spec;
  spec.width = 17;
  spec.height = 11;
  spec.progressive = progressive;
  spec.samples = hemiray::test::gradient_rgb(17, 11);
  return make_jpeg(spec);
}

Bytes small_exr() {
  Image image;
  image.width = 9;
  image.height = 40;  // three chunks of 16 lines
  image.metadata["seed"] = "1";
  Layer beauty{"", {"R", "G", "B"}, {}};
  for (std::size_t i = 0; i < image.pixel_count() * 3; ++i) beauty.data.push_back(static_cast<float>(i) * 0.37F);
  image.layers = {beauty, {"depth", {"Z"}, std::vector<float>(image.pixel_count(), 2.5F)}};
  return hemiray::encode_exr(image);
}

// The message of the InputError, which must be one line that starts with the place.
std::string error_of(const Decoder& decoder, const Bytes& bytes) {
  try {
    decoder(bytes);
  } catch (const InputError& error) {
    const std::string message = error.what();
    CHECK(message.starts_with("hostile: "));
    CHECK(message.find('\n') == std::string::npos);
    return message;
  }
  return "decoded without an error";
}

void check_every_prefix_fails(const Bytes& whole, const Decoder& decoder) {
  REQUIRE_NOTHROW(decoder(whole));
  for (std::size_t length = 0; length < whole.size(); ++length) {
    const Bytes prefix(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(length));
    INFO("the first " << length << " of " << whole.size() << " bytes");
    CHECK_THROWS_AS(decoder(prefix), InputError);
  }
}

// Some damage goes unseen (a JPEG has no checksum): each copy decodes or is an InputError, nothing else.
void check_damage_is_survived(const Bytes& whole, const Decoder& decoder) {
  std::mt19937 random(kSeed);
  int refused = 0;
  for (int copy = 0; copy < kDamagedCopies; ++copy) {
    Bytes damaged = whole;
    const unsigned flips = 1 + random() % 4;
    for (unsigned i = 0; i < flips; ++i) {
      const std::size_t at = random() % damaged.size();
      damaged[at] = static_cast<std::uint8_t>(damaged[at] ^ (1U << random() % 8U));
    }
    INFO("copy " << copy << " with seed " << kSeed);
    try {
      decoder(damaged);
    } catch (const InputError&) {
      ++refused;
    }
  }
  CHECK(refused > 0);
}

void put_u32_big_endian(Bytes& bytes, std::size_t at, std::uint32_t value) {
  for (std::size_t i = 0; i < 4; ++i) bytes[at + i] = static_cast<std::uint8_t>(value >> (24 - 8 * i));
}

// With a right checksum, so that the size itself is what is refused.
Bytes png_with_size(std::uint32_t width, std::uint32_t height) {
  Bytes bytes = small_png();
  put_u32_big_endian(bytes, 16, width);
  put_u32_big_endian(bytes, 20, height);
  std::uint32_t crc = 0xffffffff;
  for (std::size_t i = 12; i < 29; ++i) {
    crc ^= bytes[i];
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1U) ^ ((crc & 1U) != 0 ? 0xedb88320U : 0U);
  }
  put_u32_big_endian(bytes, 29, ~crc);
  return bytes;
}

// Where the four integers of a window stand.
std::size_t window_offset(const Bytes& exr, const std::string& name) {
  const std::string attribute = name + std::string(1, '\0') + "box2i" + std::string(1, '\0');
  const auto found = std::search(exr.begin(), exr.end(), attribute.begin(), attribute.end());
  REQUIRE(found != exr.end());
  return static_cast<std::size_t>(found - exr.begin()) + attribute.size() + 4;
}

Bytes exr_with_windows(std::int32_t max_x, std::int32_t max_y) {
  Bytes bytes = small_exr();
  for (const std::string name : {"dataWindow", "displayWindow"}) {
    const std::size_t at = window_offset(bytes, name);
    std::memcpy(bytes.data() + at + 8, &max_x, 4);
    std::memcpy(bytes.data() + at + 12, &max_y, 4);
  }
  return bytes;
}

// Where an attribute begins, by its name and its type.
Bytes::iterator attribute_in(Bytes& exr, const std::string& name, const std::string& type) {
  const std::string words = name + std::string(1, '\0') + type + std::string(1, '\0');
  const auto found = std::search(exr.begin(), exr.end(), words.begin(), words.end());
  REQUIRE(found != exr.end());
  return found;
}

// An attribute as the file has it.
Bytes attribute_bytes(const std::string& name, const std::string& type, const Bytes& value) {
  Bytes bytes(name.begin(), name.end());
  bytes.push_back(0);
  bytes.insert(bytes.end(), type.begin(), type.end());
  bytes.push_back(0);
  for (unsigned i = 0; i < 4; ++i) bytes.push_back(static_cast<std::uint8_t>(value.size() >> (8 * i)));
  bytes.insert(bytes.end(), value.begin(), value.end());
  return bytes;
}

// `smuggled` lies within a float's value for a reader that believes the attribute's size, and is an attribute of its
// own for one that believes its type.
Bytes exr_that_reads_in_two_ways(const Bytes& smuggled) {
  Bytes bytes = small_exr();
  Bytes value{0, 0, 128, 63};
  value.insert(value.end(), smuggled.begin(), smuggled.end());
  const Bytes carrier = attribute_bytes("carrier", "float", value);
  bytes.insert(attribute_in(bytes, "lineOrder", "lineOrder"), carrier.begin(), carrier.end());
  return bytes;
}

}  // namespace

TEST_CASE("every truncated PNG, JPEG and EXR is refused") {
  check_every_prefix_fails(small_png(), decode_texture);
  check_every_prefix_fails(small_jpeg(false), decode_texture);
  check_every_prefix_fails(small_jpeg(true), decode_texture);
  check_every_prefix_fails(small_exr(), decode_layers);
}

TEST_CASE("damaged PNG, JPEG and EXR files are refused or read, nothing else") {
  check_damage_is_survived(small_png(), decode_texture);
  check_damage_is_survived(small_jpeg(false), decode_texture);
  check_damage_is_survived(small_jpeg(true), decode_texture);
  check_damage_is_survived(small_exr(), decode_layers);
}

TEST_CASE("images that are no images are named so") {
  CHECK(error_of(decode_texture, {}) == "hostile: the image file is empty");
  CHECK_THAT(error_of(decode_texture, {'G', 'I', 'F', '8', '9', 'a'}), Catch::Contains("neither a PNG nor a JPEG"));
  CHECK(error_of(decode_layers, {}) == "hostile: the file is empty");
  CHECK_THAT(error_of(decode_layers, Bytes(100, 'x')), Catch::Contains("not an OpenEXR file"));
}

TEST_CASE("absurd sizes are refused before anything is allocated") {
  CHECK_THAT(error_of(decode_texture, png_with_size(0, 11)), Catch::Contains("broken or truncated PNG"));
  CHECK_THAT(error_of(decode_texture, png_with_size(20000, 11)), Catch::Contains("20000 x 11, more than the limit"));
  CHECK_THAT(error_of(decode_texture, png_with_size(16384, 16384)), Catch::Contains("more than the limit"));
  CHECK_THAT(error_of(decode_texture, png_with_size(10000, 10000)), Catch::Contains("too little data for its size"));

  Bytes jpeg = small_jpeg(false);
  const Bytes marker{0xff, 0xc0};
  const auto frame = std::search(jpeg.begin(), jpeg.end(), marker.begin(), marker.end());
  REQUIRE(frame != jpeg.end());
  *(frame + 5) = 0x70;  // 28683 lines
  CHECK_THAT(error_of(decode_texture, jpeg), Catch::Contains("more than the limit"));
  *(frame + 5) = 0x3f;
  *(frame + 7) = 0x1f;
  CHECK_THAT(error_of(decode_texture, jpeg), Catch::Contains("too little data for its size"));

  CHECK_THAT(error_of(decode_layers, exr_with_windows(20000, 5)), Catch::Contains("more than the limit"));
  CHECK_THAT(error_of(decode_layers, exr_with_windows(2147483647, 2147483647)), Catch::Contains("more than the limit"));
  CHECK_THAT(error_of(decode_layers, exr_with_windows(2000, 2000)), Catch::Contains("more than the limit"));
  CHECK_THAT(error_of(decode_layers, exr_with_windows(-1, 5)), Catch::Contains("no pixels"));
}

TEST_CASE("a JPEG of a thousand scans is refused") {
  JpegSpec spec;
  spec.width = 17;
  spec.height = 11;
  spec.separate_scans = true;
  spec.samples = hemiray::test::gradient_rgb(17, 11);
  const Bytes bytes = make_jpeg(spec);
  REQUIRE_NOTHROW(decode_texture(bytes));
  const Bytes start_of_scan{0xff, 0xda};
  const auto last = std::find_end(bytes.begin(), bytes.end(), start_of_scan.begin(), start_of_scan.end());
  REQUIRE(last != bytes.end());
  const Bytes scan(last, bytes.end() - 2);
  Bytes many(bytes.begin(), bytes.end() - 2);
  for (int i = 0; i < 1000; ++i) many.insert(many.end(), scan.begin(), scan.end());
  many.insert(many.end(), {0xff, 0xd9});
  CHECK_THAT(error_of(decode_texture, many), Catch::Contains("scans"));
}

TEST_CASE("an EXR that is missing, a folder, multi-part or deep says so") {
  const hemiray::test::TempFolder folder;
  CHECK_THROWS_WITH(hemiray::read_exr(folder / "none.exr"), (folder / "none.exr").string() + ": no such file");
  CHECK_THROWS_WITH(hemiray::read_exr(folder.path()), Catch::Contains("is not a regular file"));
  Bytes bytes = small_exr();
  bytes[5] = 0x10;
  CHECK_THAT(error_of(decode_layers, bytes), Catch::Contains("multi-part"));
  bytes[5] = 0x08;
  CHECK_THAT(error_of(decode_layers, bytes), Catch::Contains("deep"));
}

// Found by the fuzzer: our buffers had the window's size that we had read, the library wrote by the one it had read.
TEST_CASE("EXR: a header that reads in two ways is refused") {
  const Bytes larger_window{0, 0, 0, 0, 0, 0, 0, 0, 200, 0, 0, 0, 200, 0, 0, 0};
  const Bytes smuggled = attribute_bytes("dataWindow", "box2i", larger_window);
  CHECK(error_of(decode_layers, exr_that_reads_in_two_ways(smuggled)).find("type's size") != std::string::npos);

  Bytes trailing = small_exr();
  const auto channels = attribute_in(trailing, "channels", "chlist");
  const auto size = channels + 16, value = size + 4;  // "channels", "chlist" and their zeros
  const auto end = value + *size;
  *size = static_cast<std::uint8_t>(*size + smuggled.size());
  trailing.insert(end, smuggled.begin(), smuggled.end());
  CHECK(error_of(decode_layers, trailing).find("follows the last channel") != std::string::npos);
}
