// The memory streams, and the walk over an EXR header (OpenEXR file layout, "Magic number, version, header").
#include "host/base/exr_stream.hpp"

#include <algorithm>
#include <cstring>
#include <iterator>
#include <stdexcept>
#include <string_view>

#include "host/base/error.hpp"

namespace hemiray {

ExrMemoryInput::ExrMemoryInput(std::span<const std::uint8_t> bytes, const std::string& place)
    : Imf::IStream(place.c_str()), bytes_(bytes) {}

bool ExrMemoryInput::read(char* out, int count) {
  if (count < 0 || static_cast<std::uint64_t>(count) > bytes_.size() - position_) {
    throw std::out_of_range("the file ends early");
  }
  std::memcpy(out, bytes_.data() + position_, static_cast<std::size_t>(count));
  position_ += static_cast<std::uint64_t>(count);
  return position_ < bytes_.size();
}

void ExrMemoryInput::seekg(std::uint64_t position) {
  if (position > bytes_.size()) throw std::out_of_range("the file ends early");
  position_ = position;
}

void ExrMemoryOutput::write(const char* data, int count) {
  const auto size = static_cast<std::size_t>(count);
  if (position_ + size > bytes_.size()) bytes_.resize(position_ + size);
  std::memcpy(bytes_.data() + position_, data, size);
  position_ += size;
}

namespace {

constexpr std::uint32_t kMagic = 20000630;
constexpr std::uint32_t kVersionMask = 0xff;
constexpr std::uint32_t kVersion = 2;
constexpr std::uint32_t kTiledFlag = 0x200;
constexpr std::uint32_t kDeepFlag = 0x800;
constexpr std::uint32_t kMultiPartFlag = 0x1000;
constexpr std::size_t kMaxNameLength = 255;

// Bytes of the types of attributes that have a fixed size (OpenEXR file layout, "Predefined Attribute Types"). The
// library reads that many whatever the file claims, and from there on would read another header than we do.
struct FixedSize {
  std::string_view type;
  std::size_t bytes;
};
constexpr FixedSize kFixedSizes[] = {
    {"box2f", 16},      {"box2i", 16},   {"chromaticities", 32},
    {"compression", 1}, {"double", 8},   {"envmap", 1},
    {"float", 4},       {"int", 4},      {"keycode", 28},
    {"lineOrder", 1},   {"m33d", 72},    {"m33f", 36},
    {"m44d", 128},      {"m44f", 64},    {"rational", 8},
    {"tiledesc", 9},    {"timecode", 8}, {"v2d", 16},
    {"v2f", 8},         {"v2i", 8},      {"v3d", 24},
    {"v3f", 12},        {"v3i", 12},     {"deepImageState", 1},
};

/// Little-endian values one after the other; throws InputError past the end.
class HeaderCursor {
 public:
  HeaderCursor(std::span<const std::uint8_t> bytes, const std::string& place) : bytes_(bytes), place_(place) {}

  std::span<const std::uint8_t> take(std::size_t count) {
    if (count > bytes_.size()) fail("the header is cut short");
    const auto taken = bytes_.first(count);
    bytes_ = bytes_.subspan(count);
    return taken;
  }
  std::uint32_t take_u32() {
    const auto b = take(4);
    return std::uint32_t{b[0]} | std::uint32_t{b[1]} << 8U | std::uint32_t{b[2]} << 16U | std::uint32_t{b[3]} << 24U;
  }
  std::int64_t take_i32() { return static_cast<std::int32_t>(take_u32()); }
  std::string_view take_name() {
    const std::size_t limit = std::min(bytes_.size(), kMaxNameLength + 1);
    const auto end = std::find(bytes_.begin(), bytes_.begin() + static_cast<std::ptrdiff_t>(limit), 0);
    if (end == bytes_.begin() + static_cast<std::ptrdiff_t>(limit)) fail("a name in the header does not end");
    const auto length = static_cast<std::size_t>(end - bytes_.begin());
    const std::string_view name(reinterpret_cast<const char*>(bytes_.data()), length);
    bytes_ = bytes_.subspan(length + 1);
    return name;
  }
  [[nodiscard]] bool at_end() const { return bytes_.empty(); }
  [[noreturn]] void fail(const std::string& what) const {
    throw InputError(place_, "broken or truncated EXR file (" + what + "); save it again");
  }

 private:
  std::span<const std::uint8_t> bytes_;
  const std::string& place_;
};

ExrHeaderFacts::Window parse_window(HeaderCursor value) {
  ExrHeaderFacts::Window window;
  window.min_x = value.take_i32();
  window.min_y = value.take_i32();
  window.max_x = value.take_i32();
  window.max_y = value.take_i32();
  return window;
}

void parse_channels(HeaderCursor value, ExrHeaderFacts& facts) {
  while (!value.take_name().empty()) {
    value.take(8);  // type, linearity flag, padding
    const std::int64_t x_sampling = value.take_i32();
    const std::int64_t y_sampling = value.take_i32();
    facts.subsampled = facts.subsampled || x_sampling != 1 || y_sampling != 1;
    ++facts.channel_count;
  }
  if (!value.at_end()) value.fail("something follows the last channel");
}

bool has_its_types_size(std::string_view type, std::size_t bytes) {
  const auto* const found = std::find_if(std::begin(kFixedSizes), std::end(kFixedSizes),
                                         [&](const FixedSize& fixed) { return fixed.type == type; });
  return found == std::end(kFixedSizes) || found->bytes == bytes;
}

}  // namespace

ExrHeaderFacts inspect_exr_header(std::span<const std::uint8_t> bytes, const std::string& place) {
  if (bytes.empty()) throw InputError(place, "the file is empty");
  HeaderCursor cursor(bytes, place);
  if (bytes.size() < 8 || cursor.take_u32() != kMagic) throw InputError(place, "not an OpenEXR file");
  const std::uint32_t version = cursor.take_u32();
  if ((version & kVersionMask) != kVersion) cursor.fail("unknown file version");
  ExrHeaderFacts facts;
  facts.tiled = (version & kTiledFlag) != 0;
  facts.deep = (version & kDeepFlag) != 0;
  facts.multi_part = (version & kMultiPartFlag) != 0;

  bool has_channels = false;
  bool has_data_window = false;
  bool has_display_window = false;
  bool has_tiles = false;
  // One of each: where a name came twice, the library might believe the other one.
  const auto mark = [&](bool& seen) {
    if (seen) cursor.fail("an attribute appears twice");
    seen = true;
  };
  for (std::string_view name = cursor.take_name(); !name.empty(); name = cursor.take_name()) {
    const std::string_view type = cursor.take_name();
    const auto value = cursor.take(cursor.take_u32());
    if (!has_its_types_size(type, value.size())) cursor.fail("an attribute is not of its type's size");
    const HeaderCursor content(value, place);
    if (name == "channels" && type == "chlist") {
      mark(has_channels);
      parse_channels(content, facts);
    } else if (name == "dataWindow" && type == "box2i") {
      mark(has_data_window);
      facts.data_window = parse_window(content);
    } else if (name == "displayWindow" && type == "box2i") {
      mark(has_display_window);
      facts.display_window = parse_window(content);
    } else if (name == "tiles" && type == "tiledesc") {
      mark(has_tiles);
      HeaderCursor tiles = content;
      facts.tile_width = tiles.take_u32();
      facts.tile_height = tiles.take_u32();
    }
  }
  if (!has_channels || facts.channel_count == 0) cursor.fail("no channels");
  if (!has_data_window || !has_display_window) cursor.fail("no data or display window");
  if (facts.tiled && !has_tiles) cursor.fail("no tile size");
  return facts;
}

}  // namespace hemiray
