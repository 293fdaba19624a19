// Streams in memory for the OpenEXR library, so that files are read and written by us.
#pragma once

#include <ImfIO.h>

#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace hemiray {

/// Reads from bytes that outlive it. Reading or seeking past the end throws std::out_of_range.
class ExrMemoryInput : public Imf::IStream {
 public:
  ExrMemoryInput(std::span<const std::uint8_t> bytes, const std::string& place);
  bool read(char* out, int count) override;
  std::uint64_t tellg() override { return position_; }
  void seekg(std::uint64_t position) override;

 private:
  std::span<const std::uint8_t> bytes_;
  std::uint64_t position_ = 0;
};

/// Grows as it is written.
class ExrMemoryOutput : public Imf::OStream {
 public:
  ExrMemoryOutput() : Imf::OStream("memory") {}
  void write(const char* data, int count) override;
  std::uint64_t tellp() override { return position_; }
  void seekp(std::uint64_t position) override { position_ = position; }
  [[nodiscard]] std::vector<std::uint8_t> take() { return std::move(bytes_); }

 private:
  std::vector<std::uint8_t> bytes_;
  std::uint64_t position_ = 0;
};

/// What the header says, as far as it decides whether the file may be given to the library.
struct ExrHeaderFacts {
  bool multi_part = false;
  bool deep = false;
  bool tiled = false;
  bool subsampled = false;
  std::uint64_t channel_count = 0;
  std::int64_t tile_width = 0;
  std::int64_t tile_height = 0;
  struct Window {
    std::int64_t min_x = 0, min_y = 0, max_x = -1, max_y = -1;  ///< inclusive
    bool operator==(const Window&) const = default;
    [[nodiscard]] std::int64_t width() const { return max_x - min_x + 1; }
    [[nodiscard]] std::int64_t height() const { return max_y - min_y + 1; }
  } data_window, display_window;
};

/// Walks the (first) header within the bounds of the file, before the library allocates by what it claims.
/// Throws InputError(place, ...) where it is not an EXR header, is cut short, or lacks the channels or the windows.
[[nodiscard]] ExrHeaderFacts inspect_exr_header(std::span<const std::uint8_t> bytes, const std::string& place);

}  // namespace hemiray
