// Decodes the PNG and JPEG files that scenes use as textures.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace hemiray {

/// 8-bit pixels as stored in the file (no gamma applied), row-major from the top left, 4 bytes a pixel: R, G, B, A.
/// Files without alpha get A = 255.
struct DecodedImage {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> rgba;
};

/// Limits of what is decoded, checked before the pixels are allocated: texels on a side, and texels in all (512 MiB).
inline constexpr std::uint32_t kMaxTextureSide = 16384;
inline constexpr std::uint64_t kMaxTexturePixels = std::uint64_t{1} << 27U;

/// Decodes a PNG (all colour types and depths; 16 bits are rounded to 8) or a JPEG (grey, YCbCr, RGB, CMYK, YCCK),
/// told apart by their first bytes. Embedded colour profiles, gamma and EXIF orientation are ignored.
/// Throws InputError(place, ...) for other formats, images over the limits, and truncated or corrupt data.
[[nodiscard]] DecodedImage decode_image(std::span<const std::uint8_t> bytes, const std::string& place);

}  // namespace hemiray
