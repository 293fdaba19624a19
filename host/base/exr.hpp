// OpenEXR files: images of named layers in and out.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "host/base/image.hpp"

namespace hemiray {

/// Limits of what is read, checked before the pixels are allocated: pixels on a side of the data or display window, and
/// floats in all (pixels times channels; 2 GiB).
inline constexpr std::int64_t kMaxExrSide = 16384;
inline constexpr std::uint64_t kMaxExrValues = std::uint64_t{1} << 29U;

/// Writes `image` as a scan-line EXR, ZIP compressed, every channel 32-bit float, atomically (see atomic_file.hpp).
/// Layer "" becomes plain channels (R, G, B), others "layer.C"; metadata become string attributes "hemiray:key".
/// Throws std::invalid_argument where the image is not well formed (no pixels, a layer of another size, a channel name
/// that is empty, repeated or holds a dot), InputError or DeviceError where `path` cannot be written.
void write_exr(const std::filesystem::path& path, const Image& image);

/// The bytes that write_exr writes.
[[nodiscard]] std::vector<std::uint8_t> encode_exr(const Image& image);

/// Reads a single-part scan-line or tiled EXR with half, float or uint channels. Channels are grouped into layers by
/// the last dot of their names; layer "" comes first, the others by name; within a layer R, G, B, A come first, others
/// by name. The image is the display window: pixels outside the data window are 0, data outside it are dropped.
/// String attributes "hemiray:key" become metadata. Throws InputError naming the file where it is missing, corrupt,
/// truncated, over the limits, multi-part, deep, or has subsampled channels.
[[nodiscard]] Image read_exr(const std::filesystem::path& path);

/// The same from memory; `place` stands for the file in errors, `max_values` replaces kMaxExrValues.
[[nodiscard]] Image decode_exr(std::span<const std::uint8_t> bytes, const std::string& place,
                               std::uint64_t max_values = kMaxExrValues);

}  // namespace hemiray
