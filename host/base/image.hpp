// A float image of named layers in memory.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

namespace hemiray {

/// One named layer. Channel names are the EXR ones without the layer's prefix: {"R","G","B"}, {"Z"}, {"X","Y","Z"}.
/// `data` is row-major from the top left, channels interleaved: data[(y * width + x) * channels.size() + c].
struct Layer {
  std::string name;  ///< "" is the beauty layer (plain R, G, B [, A] in the EXR file)
  std::vector<std::string> channels;
  std::vector<float> data;
};

/// Layers of one size and the text metadata that goes into the file's header.
struct Image {
  int width = 0;
  int height = 0;
  std::vector<Layer> layers;
  std::map<std::string, std::string> metadata;

  /// The layer of that name, or nullptr.
  [[nodiscard]] const Layer* find(const std::string& name) const {
    for (const Layer& layer : layers) {
      if (layer.name == name) return &layer;
    }
    return nullptr;
  }
  [[nodiscard]] std::size_t pixel_count() const {
    return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  }
};

}  // namespace hemiray
