// The OpenEXR library does the coding; what it may allocate is bounded here before it sees a file.
#include "host/base/exr.hpp"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfOutputFile.h>
#include <ImfStringAttribute.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <new>
#include <set>
#include <stdexcept>
#include <system_error>

#include "host/base/atomic_file.hpp"
#include "host/base/error.hpp"
#include "host/base/exr_stream.hpp"

namespace hemiray {
namespace {

namespace fs = std::filesystem;

const std::string kMetadataPrefix = "hemiray:";
constexpr std::uintmax_t kMaxFileBytes = std::uintmax_t{4} << 30U;

std::string full_channel_name(const Layer& layer, std::size_t channel) {
  return layer.name.empty() ? layer.channels[channel] : layer.name + "." + layer.channels[channel];
}

void check_well_formed(const Image& image) {
  if (image.width <= 0 || image.height <= 0) throw std::invalid_argument("the image has no pixels");
  if (image.layers.empty()) throw std::invalid_argument("the image has no layers");
  std::set<std::string> names;
  for (const Layer& layer : image.layers) {
    if (layer.channels.empty() || layer.data.size() != image.pixel_count() * layer.channels.size()) {
      throw std::invalid_argument("layer \"" + layer.name + "\" does not have the image's size");
    }
    for (std::size_t c = 0; c < layer.channels.size(); ++c) {
      const std::string& channel = layer.channels[c];
      if (channel.empty() || channel.find('.') != std::string::npos ||
          !names.insert(full_channel_name(layer, c)).second) {
        throw std::invalid_argument("layer \"" + layer.name + "\" has a bad channel name \"" + channel + "\"");
      }
    }
  }
}

// A slice over one channel of interleaved floats whose first pixel is (min_x, min_y) of the file.
Imf::Slice slice_of(const float* data, std::size_t channel, std::size_t channel_count,
                    const ExrHeaderFacts::Window& window) {
  const std::size_t x_stride = channel_count * sizeof(float);
  const std::size_t y_stride = x_stride * static_cast<std::size_t>(window.width());
  const Imath::Box2i box(Imath::V2i(static_cast<int>(window.min_x), static_cast<int>(window.min_y)),
                         Imath::V2i(static_cast<int>(window.max_x), static_cast<int>(window.max_y)));
  return Imf::Slice::Make(Imf::FLOAT, data + channel, box, x_stride, y_stride);
}

// R, G, B, A before the others, these by name.
std::pair<int, std::string> channel_order(const std::string& channel) {
  constexpr std::array<const char*, 4> kFirst{"R", "G", "B", "A"};
  const auto found = std::find(kFirst.begin(), kFirst.end(), channel);
  return {static_cast<int>(found - kFirst.begin()), channel};
}

// Layers with their channels, still without data.
std::vector<Layer> layers_of(const Imf::ChannelList& channels) {
  std::map<std::string, std::vector<std::string>> grouped;
  for (auto channel = channels.begin(); channel != channels.end(); ++channel) {
    const std::string name = channel.name();
    const std::size_t dot = name.rfind('.');
    if (dot == std::string::npos) {
      grouped[""].push_back(name);
    } else {
      grouped[name.substr(0, dot)].push_back(name.substr(dot + 1));
    }
  }
  std::vector<Layer> layers;
  for (auto& [name, names] : grouped) {
    std::sort(names.begin(), names.end(),
              [](const std::string& a, const std::string& b) { return channel_order(a) < channel_order(b); });
    layers.push_back({name, names, {}});
  }
  return layers;
}

void check_limits(const ExrHeaderFacts& facts, const std::string& place, std::uint64_t max_values) {
  if (facts.deep) throw InputError(place, "deep EXR files are not supported; flatten it first");
  if (facts.multi_part) throw InputError(place, "multi-part EXR files are not supported; save its parts one by one");
  if (facts.subsampled) throw InputError(place, "subsampled channels are not supported; save it as R, G, B");
  for (const auto& window : {facts.data_window, facts.display_window}) {
    if (window.width() <= 0 || window.height() <= 0) throw InputError(place, "the image has no pixels");
    const bool fits = window.width() <= kMaxExrSide && window.height() <= kMaxExrSide &&
                      static_cast<std::uint64_t>(window.width() * window.height()) <= max_values / facts.channel_count;
    if (!fits) {
      throw InputError(place, "the image is " + std::to_string(window.width()) + " x " +
                                  std::to_string(window.height()) + " with " + std::to_string(facts.channel_count) +
                                  " channels, more than the limit of " + std::to_string(kMaxExrSide) +
                                  " on a side and " + std::to_string(max_values >> 20U) +
                                  " Mi values in all; scale it down");
    }
  }
  const bool tile_fits =
      facts.tile_width > 0 && facts.tile_height > 0 && facts.tile_width <= kMaxExrSide &&
      facts.tile_height <= kMaxExrSide &&
      static_cast<std::uint64_t>(facts.tile_width * facts.tile_height) <= max_values / facts.channel_count;
  if (facts.tiled && !tile_fits)
    throw InputError(place, "the EXR file has absurdly large or empty tiles; save it again");
}

// Moves layers from the data window's pixels to the display window's.
void fit_to_display(Image& image, const ExrHeaderFacts::Window& data, const ExrHeaderFacts::Window& display) {
  image.width = static_cast<int>(display.width());
  image.height = static_cast<int>(display.height());
  if (data == display) return;
  const std::int64_t first_x = std::max(data.min_x, display.min_x);
  const std::int64_t end_x = std::min(data.max_x, display.max_x) + 1;
  for (Layer& layer : image.layers) {
    const auto channels = static_cast<std::int64_t>(layer.channels.size());
    std::vector<float> moved(image.pixel_count() * layer.channels.size(), 0.0F);
    for (std::int64_t y = std::max(data.min_y, display.min_y); y <= std::min(data.max_y, display.max_y); ++y) {
      if (first_x >= end_x) break;
      const std::int64_t from = ((y - data.min_y) * data.width() + first_x - data.min_x) * channels;
      const std::int64_t to = ((y - display.min_y) * display.width() + first_x - display.min_x) * channels;
      std::copy_n(layer.data.begin() + from, (end_x - first_x) * channels, moved.begin() + to);
    }
    layer.data = std::move(moved);
  }
}

bool is_window(const Imath::Box2i& box, const ExrHeaderFacts::Window& window) {
  return box.min.x == window.min_x && box.min.y == window.min_y && box.max.x == window.max_x &&
         box.max.y == window.max_y;
}

// Our buffers have the sizes that we read from the header: the library must have read the same ones.
void check_agreement(const Imf::Header& header, const ExrHeaderFacts& facts, const std::string& place) {
  std::uint64_t channels = 0;
  for (auto channel = header.channels().begin(); channel != header.channels().end(); ++channel) ++channels;
  if (channels != facts.channel_count || !is_window(header.dataWindow(), facts.data_window) ||
      !is_window(header.displayWindow(), facts.display_window)) {
    throw InputError(place, "broken EXR file (its header can be read in two ways); save it again");
  }
}

Image decode_with_library(std::span<const std::uint8_t> bytes, const std::string& place, const ExrHeaderFacts& facts) {
  ExrMemoryInput stream(bytes, place);
  Imf::InputFile file(stream, 0);
  if (!file.isComplete()) throw InputError(place, "the EXR file is incomplete; write it again");
  const Imf::Header& header = file.header();
  check_agreement(header, facts, place);
  const ExrHeaderFacts::Window& data = facts.data_window;

  Image image;
  image.layers = layers_of(header.channels());
  Imf::FrameBuffer frame;
  const std::size_t pixel_count = static_cast<std::size_t>(data.width()) * static_cast<std::size_t>(data.height());
  for (Layer& layer : image.layers) {
    layer.data.resize(pixel_count * layer.channels.size());
    for (std::size_t c = 0; c < layer.channels.size(); ++c) {
      frame.insert(full_channel_name(layer, c), slice_of(layer.data.data(), c, layer.channels.size(), data));
    }
  }
  file.setFrameBuffer(frame);
  file.readPixels(static_cast<int>(data.min_y), static_cast<int>(data.max_y));
  fit_to_display(image, data, facts.display_window);
  for (auto attribute = header.begin(); attribute != header.end(); ++attribute) {
    const std::string name = attribute.name();
    const auto* text = dynamic_cast<const Imf::StringAttribute*>(&attribute.attribute());
    if (text != nullptr && name.starts_with(kMetadataPrefix)) {
      image.metadata[name.substr(kMetadataPrefix.size())] = text->value();
    }
  }
  return image;
}

}  // namespace

std::vector<std::uint8_t> encode_exr(const Image& image) {
  check_well_formed(image);
  Imf::Header header(image.width, image.height);
  header.compression() = Imf::ZIP_COMPRESSION;
  for (const auto& [key, value] : image.metadata) header.insert(kMetadataPrefix + key, Imf::StringAttribute(value));
  Imf::FrameBuffer frame;
  const ExrHeaderFacts::Window window{0, 0, image.width - 1, image.height - 1};
  for (const Layer& layer : image.layers) {
    for (std::size_t c = 0; c < layer.channels.size(); ++c) {
      const std::string name = full_channel_name(layer, c);
      header.channels().insert(name, Imf::Channel(Imf::FLOAT));
      frame.insert(name, slice_of(layer.data.data(), c, layer.channels.size(), window));
    }
  }
  ExrMemoryOutput stream;
  {
    Imf::OutputFile file(stream, header, 0);  // its destructor writes the table of offsets
    file.setFrameBuffer(frame);
    file.writePixels(image.height);
  }
  return stream.take();
}

void write_exr(const fs::path& path, const Image& image) { write_file_atomically(path, encode_exr(image)); }

Image decode_exr(std::span<const std::uint8_t> bytes, const std::string& place, std::uint64_t max_values) {
  const ExrHeaderFacts facts = inspect_exr_header(bytes, place);
  check_limits(facts, place, max_values);
  try {
    return decode_with_library(bytes, place, facts);
  } catch (const Error&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw DeviceError(place + ": out of memory while reading an EXR image");
  } catch (const std::exception& error) {
    std::string reason = error.what();
    std::replace(reason.begin(), reason.end(), '\n', ' ');
    throw InputError(place, "broken or truncated EXR file (" + reason + "); save it again");
  }
}

Image read_exr(const fs::path& path) {
  const std::string place = path.string();
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (!fs::exists(status)) throw InputError(place, "no such file");
  if (!fs::is_regular_file(status)) throw InputError(place, "is not a regular file; name an EXR file");
  const std::uintmax_t size = fs::file_size(path, error);
  if (error) throw InputError(place, "cannot read the file: " + error.message());
  if (size > kMaxFileBytes) throw InputError(place, "the file is larger than the limit of 4 GiB; scale the image down");
  std::vector<std::uint8_t> bytes(size);
  std::ifstream stream(path, std::ios::binary);
  stream.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  if (!stream) throw InputError(place, std::string("cannot read the file: ") + std::strerror(errno));
  return decode_exr(bytes, place);
}

}  // namespace hemiray
