// PNG and JPEG files of every kind, made in memory by the libraries' encoders.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace hemiray::test {

using Bytes = std::vector<std::uint8_t>;

/// What goes into a PNG file; `rows` as libpng wants them: packed, big-endian, top to bottom.
struct PngSpec {
  std::uint32_t width = 1;
  std::uint32_t height = 1;
  int color_type = 0;  ///< PNG_COLOR_TYPE_...
  int bit_depth = 8;
  bool interlaced = false;
  Bytes rows;
  std::vector<std::array<std::uint8_t, 3>> palette;
  Bytes palette_alpha;                            ///< tRNS of a palette
  std::optional<std::uint16_t> transparent_grey;  ///< tRNS of a grey image
};

[[nodiscard]] Bytes make_png(const PngSpec& spec);

/// What goes into a JPEG file; `samples` interleaved, top to bottom: 1 (grey), 3 (RGB, stored as YCbCr) or 4 (CMYK).
struct JpegSpec {
  std::uint32_t width = 1;
  std::uint32_t height = 1;
  int components = 3;
  bool progressive = false;
  bool separate_scans = false;  ///< one scan a component instead of one for all
  bool adobe_marker = true;     ///< of CMYK files
  Bytes samples;
};

[[nodiscard]] Bytes make_jpeg(const JpegSpec& spec);

/// A picture with some detail, 3 samples a pixel.
[[nodiscard]] Bytes gradient_rgb(std::uint32_t width, std::uint32_t height);

}  // namespace hemiray::test
