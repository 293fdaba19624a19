// PNG files of a layer, for people to look at.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "host/base/image.hpp"

namespace hemiray {

/// A linear value in [0, 1] as sRGB (IEC 61966-2-1) rounded to 8 bits; clamped; NaN gives 0.
[[nodiscard]] std::uint8_t to_srgb8(float linear);

/// The PNG bytes of one layer: linear Rec. 709 times 2^exposure_stops, clamped to [0, 1], sRGB, 8-bit RGB.
/// Shows the channels R, G, B; else X, Y, Z; else the first channel as grey. Alpha is left out.
/// Throws InputError where the image has no such layer (the message lists those there are).
[[nodiscard]] std::vector<std::uint8_t> encode_png(const Image& image, const std::string& layer_name,
                                                   double exposure_stops);

/// Writes these bytes atomically (see atomic_file.hpp for what it throws).
void write_png(const std::filesystem::path& path, const Image& image, const std::string& layer_name = "",
               double exposure_stops = 0);

}  // namespace hemiray
