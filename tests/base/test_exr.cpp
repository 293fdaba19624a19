// EXR files: what is written comes back, other programs' variants are read, the file is what any viewer expects.
#include "host/base/exr.hpp"

#include <ImfArray.h>
#include <ImfChannelList.h>
#include <ImfInputFile.h>
#include <ImfOutputFile.h>
#include <ImfRgbaFile.h>
#include <ImfStringAttribute.h>
#include <ImfTiledOutputFile.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "host/base/error.hpp"
#include "tests/support/temp_folder.hpp"

using hemiray::Image;
using hemiray::Layer;
using hemiray::read_exr;
using hemiray::write_exr;
using hemiray::test::TempFolder;

namespace {

Layer numbered_layer(const std::string& name, const std::vector<std::string>& channels, std::size_t pixels,
                     float start) {
  Layer layer{name, channels, {}};
  for (std::size_t i = 0; i < pixels * channels.size(); ++i) layer.data.push_back(start + static_cast<float>(i) * 0.1F);
  return layer;
}

Image layered_image() {
  Image image;
  image.width = 7;
  image.height = 35;
  image.layers = {numbered_layer("", {"R", "G", "B"}, 7 * 35, -3.0F), numbered_layer("depth", {"Z"}, 7 * 35, 1e6F),
                  numbered_layer("light.key", {"R", "G", "B", "A"}, 7 * 35, 0.0F),
                  numbered_layer("normal", {"X", "Y", "Z"}, 7 * 35, -1.0F)};
  image.metadata = {{"version", "0.1.0"}, {"options", "--size 7x35 \"quoted\""}};
  return image;
}

// A file of one row of UINT, HALF and FLOAT channels by the library itself.
void write_mixed_types(const std::string& path) {
  Imf::Header header(2, 1);
  std::vector<unsigned> ids{3, 70000};
  std::vector<half> halves{half(0.5F), half(-2.0F)};
  std::vector<float> floats{1e-20F, 1e20F};
  header.channels().insert("id", Imf::Channel(Imf::UINT));
  header.channels().insert("h.G", Imf::Channel(Imf::HALF));
  header.channels().insert("h.R", Imf::Channel(Imf::FLOAT));
  Imf::FrameBuffer frame;
  frame.insert("id", Imf::Slice(Imf::UINT, reinterpret_cast<char*>(ids.data()), 4, 8));
  frame.insert("h.G", Imf::Slice(Imf::HALF, reinterpret_cast<char*>(halves.data()), 2, 4));
  frame.insert("h.R", Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(floats.data()), 4, 8));
  Imf::OutputFile file(path.c_str(), header);
  file.setFrameBuffer(frame);
  file.writePixels(1);
}

// One float channel "Y" whose value is 100 * y + x in file coordinates.
void write_window(const std::string& path, const Imath::Box2i& display, const Imath::Box2i& data, bool tiled) {
  Imf::Header header(display, data);
  header.channels().insert("Y", Imf::Channel(Imf::FLOAT));
  std::vector<float> values;
  for (int y = data.min.y; y <= data.max.y; ++y) {
    for (int x = data.min.x; x <= data.max.x; ++x) values.push_back(static_cast<float>(100 * y + x));
  }
  const auto width = static_cast<std::size_t>(data.max.x - data.min.x + 1);
  Imf::FrameBuffer frame;
  frame.insert("Y", Imf::Slice::Make(Imf::FLOAT, values.data(), data, sizeof(float), width * sizeof(float)));
  if (tiled) {
    header.setTileDescription(Imf::TileDescription(2, 3, Imf::ONE_LEVEL));
    Imf::TiledOutputFile file(path.c_str(), header);
    file.setFrameBuffer(frame);
    file.writeTiles(0, file.numXTiles() - 1, 0, file.numYTiles() - 1);
  } else {
    Imf::OutputFile file(path.c_str(), header);
    file.setFrameBuffer(frame);
    file.writePixels(data.max.y - data.min.y + 1);
  }
}

}  // namespace

TEST_CASE("EXR: layers, channels, values and metadata come back as written") {
  const TempFolder folder;
  Image image = layered_image();
  image.layers[0].data[0] = std::numeric_limits<float>::infinity();
  image.layers[0].data[1] = std::numeric_limits<float>::denorm_min();
  image.layers[0].data[2] = -0.0F;
  image.layers[0].data[3] = 16777215.0F;
  write_exr(folder / "image.exr", image);
  const Image back = read_exr(folder / "image.exr");
  CHECK(back.width == image.width);
  CHECK(back.height == image.height);
  CHECK(back.metadata == image.metadata);
  REQUIRE(back.layers.size() == image.layers.size());
  for (std::size_t i = 0; i < image.layers.size(); ++i) {
    CHECK(back.layers[i].name == image.layers[i].name);
    CHECK(back.layers[i].channels == image.layers[i].channels);
    CHECK(back.layers[i].data == image.layers[i].data);
  }
  CHECK(std::signbit(back.layers[0].data[2]));
}

TEST_CASE("EXR: the file has float channels, ZIP and string attributes as other programs look for them") {
  const TempFolder folder;
  const std::string path = (folder / "image.exr").string();
  write_exr(path, layered_image());
  Imf::InputFile file(path.c_str());
  CHECK(file.header().compression() == Imf::ZIP_COMPRESSION);
  for (const char* name : {"R", "G", "B", "depth.Z", "light.key.A", "normal.X"}) {
    const Imf::Channel* channel = file.header().channels().findChannel(name);
    REQUIRE(channel != nullptr);
    CHECK(channel->type == Imf::FLOAT);
  }
  CHECK(file.header().typedAttribute<Imf::StringAttribute>("hemiray:version").value() == "0.1.0");
  // Top left is pixel (0, 0): a plain RGBA reader sees the first value there.
  Imf::RgbaInputFile rgba(path.c_str());
  Imf::Array2D<Imf::Rgba> pixels(35, 7);
  rgba.setFrameBuffer(&pixels[0][0], 1, 7);
  rgba.readPixels(0, 34);
  CHECK(static_cast<float>(pixels[0][0].r) == -3.0F);
  CHECK(static_cast<float>(pixels[1][0].r) == Approx(-3.0 + 0.1 * 21).epsilon(1e-3));
}

TEST_CASE("EXR: the same image gives the same bytes") {
  CHECK(hemiray::encode_exr(layered_image()) == hemiray::encode_exr(layered_image()));
}

TEST_CASE("EXR: half, float and uint channels are read as float") {
  const TempFolder folder;
  write_mixed_types((folder / "mixed.exr").string());
  const Image image = read_exr(folder / "mixed.exr");
  REQUIRE(image.layers.size() == 2);
  CHECK(image.layers[0].channels == std::vector<std::string>{"id"});
  CHECK(image.layers[0].data == std::vector<float>{3, 70000});
  CHECK(image.layers[1].name == "h");
  CHECK(image.layers[1].channels == std::vector<std::string>{"R", "G"});
  CHECK(image.layers[1].data == std::vector<float>{1e-20F, 0.5F, 1e20F, -2.0F});
}

TEST_CASE("EXR: the display window is the image, scan lines and tiles alike") {
  const TempFolder folder;
  const std::string path = (folder / "window.exr").string();
  const bool tiled = GENERATE(false, true);
  const auto box = [](int x0, int y0, int x1, int y1) { return Imath::Box2i(Imath::V2i(x0, y0), Imath::V2i(x1, y1)); };
  SECTION("equal windows away from the origin") {
    write_window(path, box(-3, 5, 1, 11), box(-3, 5, 1, 11), tiled);
    const Image image = read_exr(path);
    REQUIRE(image.width == 5);
    REQUIRE(image.height == 7);
    CHECK(image.layers[0].data.front() == 497.0F);
    CHECK(image.layers[0].data.back() == 1101.0F);
  }
  SECTION("a crop: black around the data") {
    write_window(path, box(0, 0, 3, 3), box(1, 2, 2, 2), tiled);
    CHECK(read_exr(path).layers[0].data == std::vector<float>{0, 0, 0, 0, 0, 0, 0, 0, 0, 201, 202, 0, 0, 0, 0, 0});
  }
  SECTION("overscan: what is outside the display is dropped") {
    write_window(path, box(0, 0, 1, 1), box(-2, -1, 4, 0), tiled);
    CHECK(read_exr(path).layers[0].data == std::vector<float>{0, 1, 0, 0});
  }
  SECTION("no overlap: black") {
    write_window(path, box(0, 0, 1, 0), box(10, 0, 12, 4), tiled);
    CHECK(read_exr(path).layers[0].data == std::vector<float>{0, 0});
  }
}

TEST_CASE("EXR: subsampled channels are refused") {
  const TempFolder folder;
  const std::string path = (folder / "chroma.exr").string();
  std::vector<Imf::Rgba> pixels(16, Imf::Rgba(1, 0.5F, 0.25F));
  {
    Imf::RgbaOutputFile file(path.c_str(), 4, 4, Imf::WRITE_YC);
    file.setFrameBuffer(pixels.data(), 1, 4);
    file.writePixels(4);
  }
  CHECK_THROWS_WITH(read_exr(path), Catch::Contains("subsampled") && Catch::StartsWith(path));
}

TEST_CASE("EXR: an unfinished file is refused") {
  const TempFolder folder;
  const std::string path = (folder / "unfinished.exr").string();
  std::vector<Imf::Rgba> pixels(64 * 64, Imf::Rgba(1, 0.5F, 0.25F));
  {
    Imf::RgbaOutputFile file(path.c_str(), 64, 64, Imf::WRITE_RGB);
    file.setFrameBuffer(pixels.data(), 1, 64);
    file.writePixels(33);
  }
  CHECK_THROWS_WITH(read_exr(path), path + ": the EXR file is incomplete; write it again");
}

TEST_CASE("EXR: images that are not well formed are not written") {
  const TempFolder folder;
  Image image = layered_image();
  SECTION("no pixels") { image.width = 0; }
  SECTION("no layers") { image.layers.clear(); }
  SECTION("another size") { image.layers[1].data.pop_back(); }
  SECTION("a dot in a channel") { image.layers[1].channels[0] = "Z.back"; }
  SECTION("an empty channel name") { image.layers[1].channels[0].clear(); }
  SECTION("two of one name") { image.layers[1].name = "normal"; }
  CHECK_THROWS_AS(write_exr(folder / "bad.exr", image), std::invalid_argument);
  CHECK(std::filesystem::is_empty(folder.path()));
}
