// Encoding through libpng into memory; see image_decode.cpp about longjmp.
#include "host/base/png.hpp"

#include <png.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <csetjmp>
#include <cstdio>
#include <new>

#include "host/base/atomic_file.hpp"
#include "host/base/error.hpp"

namespace hemiray {
namespace {

constexpr int kSetjmpError = 1;

struct PngWriter {
  png_structp png = nullptr;
  png_infop info = nullptr;
  std::vector<std::uint8_t> bytes;
  std::array<char, 160> message{};

  PngWriter() = default;
  PngWriter(const PngWriter&) = delete;
  PngWriter& operator=(const PngWriter&) = delete;
  ~PngWriter() { png_destroy_write_struct(&png, &info); }
};

extern "C" void hemiray_png_write_error(png_structp png, png_const_charp text) {
  auto* writer = static_cast<PngWriter*>(png_get_error_ptr(png));
  std::snprintf(writer->message.data(), writer->message.size(), "%s", text);
  png_longjmp(png, kSetjmpError);
}

extern "C" void hemiray_png_write_warning(png_structp /*png*/, png_const_charp /*text*/) {}

bool append(PngWriter* writer, const std::uint8_t* data, std::size_t count) noexcept {
  try {
    writer->bytes.insert(writer->bytes.end(), data, data + count);
    return true;
  } catch (const std::bad_alloc&) {
    return false;
  }
}

extern "C" void hemiray_png_write_bytes(png_structp png, png_bytep data, png_size_t count) {
  if (!append(static_cast<PngWriter*>(png_get_io_ptr(png)), data, count)) png_error(png, "out of memory");
}

extern "C" void hemiray_png_write_flush(png_structp /*png*/) {}

bool write_rows(PngWriter* writer, std::uint32_t width, std::uint32_t height, png_bytepp rows) {
  if (setjmp(png_jmpbuf(writer->png))) return false;
  png_set_write_fn(writer->png, writer, hemiray_png_write_bytes, hemiray_png_write_flush);
  png_set_IHDR(writer->png, writer->info, width, height, 8, PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE,
               PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  png_set_sRGB_gAMA_and_cHRM(writer->png, writer->info, PNG_sRGB_INTENT_RELATIVE);
  png_write_info(writer->png, writer->info);
  png_write_image(writer->png, rows);
  png_write_end(writer->png, nullptr);
  return true;
}

const Layer& find_layer(const Image& image, const std::string& name) {
  if (const Layer* layer = image.find(name); layer != nullptr) return *layer;
  std::string known;
  for (const Layer& layer : image.layers) known += (known.empty() ? "\"" : ", \"") + layer.name + "\"";
  throw InputError("layer \"" + name + "\"", "the image has no such layer; it has " + (known.empty() ? "none" : known));
}

// Which channel stands for red, green and blue.
std::array<std::size_t, 3> shown_channels(const Layer& layer) {
  for (const auto& names : {std::array{"R", "G", "B"}, std::array{"X", "Y", "Z"}}) {
    std::array<std::size_t, 3> indices{};
    bool all = true;
    for (std::size_t i = 0; i < names.size(); ++i) {
      const auto found = std::find(layer.channels.begin(), layer.channels.end(), names[i]);
      all = all && found != layer.channels.end();
      indices[i] = static_cast<std::size_t>(found - layer.channels.begin());
    }
    if (all) return indices;
  }
  return {0, 0, 0};
}

}  // namespace

std::uint8_t to_srgb8(float linear) {
  if (!(linear > 0)) return 0;
  if (linear >= 1) return 255;
  const double value = linear;
  const double encoded = value <= 0.0031308 ? 12.92 * value : 1.055 * std::pow(value, 1 / 2.4) - 0.055;
  return static_cast<std::uint8_t>(std::lround(encoded * 255));
}

std::vector<std::uint8_t> encode_png(const Image& image, const std::string& layer_name, double exposure_stops) {
  const Layer& layer = find_layer(image, layer_name);
  const std::array<std::size_t, 3> channels = shown_channels(layer);
  const double scale = std::exp2(exposure_stops);
  std::vector<std::uint8_t> rgb(image.pixel_count() * 3);
  for (std::size_t pixel = 0; pixel < image.pixel_count(); ++pixel) {
    for (std::size_t c = 0; c < 3; ++c) {
      const double value = layer.data[pixel * layer.channels.size() + channels[c]];
      rgb[pixel * 3 + c] = to_srgb8(static_cast<float>(value * scale));
    }
  }

  PngWriter writer;
  writer.png =
      png_create_write_struct(PNG_LIBPNG_VER_STRING, &writer, hemiray_png_write_error, hemiray_png_write_warning);
  if (writer.png != nullptr) writer.info = png_create_info_struct(writer.png);
  if (writer.info == nullptr) throw DeviceError("out of memory while writing a PNG image");
  std::vector<png_bytep> rows(static_cast<std::size_t>(image.height));
  for (std::size_t y = 0; y < rows.size(); ++y) rows[y] = rgb.data() + y * static_cast<std::size_t>(image.width) * 3;
  if (!write_rows(&writer, static_cast<std::uint32_t>(image.width), static_cast<std::uint32_t>(image.height),
                  rows.data())) {
    throw DeviceError(std::string("cannot encode a PNG image: ") + writer.message.data());
  }
  return std::move(writer.bytes);
}

void write_png(const std::filesystem::path& path, const Image& image, const std::string& layer_name,
               double exposure_stops) {
  write_file_atomically(path, encode_png(image, layer_name, exposure_stops));
}

}  // namespace hemiray
