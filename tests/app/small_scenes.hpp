// Scenes for tests of the program: small, few features, quick to compile; and what such tests look at.
#pragma once

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>
#include <string>

#include "host/base/image.hpp"

namespace hemiray::test {

/// A matte floor under a point light: no mirror, no glass, no random numbers but for where in its pixel a ray starts.
inline constexpr const char* kMatteScene = R"({
  "hemiray": 1,
  "camera": { "position": [0, 1, 3], "look_at": [0, 0, 0], "fov": 45, "size": [24, 16] },
  "materials": { "floor": { "kd": [0.7, 0.5, 0.3] } },
  "objects": [
    { "type": "quad", "material": "floor", "corner": [-1, 0, 1], "edge_u": [2, 0, 0], "edge_v": [0, 0, -2] }
  ],
  "lights": [ { "type": "point", "position": [0.5, 2, 0.5], "intensity": [9, 9, 9] } ]
})";

/// A glass ball over a mirror before a matte floor under a jittered area light: every layer has something to show.
inline constexpr const char* kGlassScene = R"({
  "hemiray": 1,
  "camera": { "position": [0, 1, 3], "look_at": [0, 0.3, 0], "fov": 45, "size": [24, 16] },
  "depth": 3,
  "materials": {
    "floor": { "kd": [0.7, 0.5, 0.3] },
    "mirror": { "kd": 0.1, "kr": 0.8 },
    "glass": { "kd": 0, "kr": 1, "kt": 1, "ior": 1.5 }
  },
  "objects": [
    { "type": "quad", "material": "floor", "corner": [-2, 0, 1], "edge_u": [4, 0, 0], "edge_v": [0, 0, -4] },
    { "type": "quad", "material": "mirror", "corner": [-1.5, 0, -1], "edge_u": [3, 0, 0], "edge_v": [0, 1, 0] },
    { "type": "sphere", "material": "glass", "center": [0, 0.5, 0.5], "radius": 0.4 }
  ],
  "lights": [
    { "type": "area", "corner": [-0.5, 2, -0.5], "edge_u": [1, 0, 0], "edge_v": [0, 0, 1], "radiance": 6,
      "samples": [2, 2], "jitter": true }
  ]
})";

/// Whether no value of any layer is NaN. Depth may be infinite where nothing was hit.
inline bool has_no_nan(const Image& image) {
  return std::all_of(image.layers.begin(), image.layers.end(), [](const Layer& layer) {
    return std::none_of(layer.data.begin(), layer.data.end(), [](float value) { return std::isnan(value); });
  });
}

/// The largest colour value of a layer, alpha left out; 0 where there is no such layer.
inline float brightest(const Image& image, const std::string& name) {
  const Layer* layer = image.find(name);
  float most = 0.0F;
  for (std::size_t i = 0; layer != nullptr && i < layer->data.size(); ++i) {
    if (layer->channels[i % layer->channels.size()] != "A") most = std::max(most, layer->data[i]);
  }
  return most;
}

/// Names of everything in a folder and its subfolders, hidden files, too.
inline std::set<std::string> listing(const std::filesystem::path& folder) {
  std::set<std::string> names;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    names.insert(entry.path().lexically_relative(folder).string());
  }
  return names;
}

}  // namespace hemiray::test
