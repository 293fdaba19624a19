// Matching, then one pass a layer; sums are kept in double.
#include "host/base/compare.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <tuple>

#include "host/base/error.hpp"

namespace hemiray {
namespace {

std::string quoted(const std::string& layer) { return layer.empty() ? "the beauty layer" : "layer \"" + layer + "\""; }

std::string size_text(const Image& image) { return std::to_string(image.width) + " x " + std::to_string(image.height); }

std::string joined(std::vector<std::string> names) {
  std::sort(names.begin(), names.end());
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

/// A layer of both images, and where the channels of B are in A.
struct LayerPair {
  const Layer& a;
  const Layer& b;
  std::vector<std::size_t> channel_in_a;
};

LayerPair match_channels(const Layer& a, const Layer& b, const std::string& name_a, const std::string& name_b) {
  LayerPair pair{a, b, {}};
  for (const std::string& channel : b.channels) {
    const auto found = std::find(a.channels.begin(), a.channels.end(), channel);
    if (found == a.channels.end() || a.channels.size() != b.channels.size()) {
      throw InputError(name_a, quoted(b.name) + " has the channels " + joined(a.channels) + ", that of " + name_b +
                                   " has " + joined(b.channels) + "; compare images with the same channels");
    }
    pair.channel_in_a.push_back(static_cast<std::size_t>(found - a.channels.begin()));
  }
  return pair;
}

std::vector<LayerPair> match_layers(const Image& a, const Image& b, const std::string& name_a,
                                    const std::string& name_b) {
  if (a.width != b.width || a.height != b.height) {
    throw InputError(
        name_a, "is " + size_text(a) + ", but " + name_b + " is " + size_text(b) + "; compare images of the same size");
  }
  if (b.layers.empty() || b.pixel_count() == 0)
    throw InputError(name_b, "the image is empty; there is nothing to compare");
  for (const Layer& layer : a.layers) {
    if (b.find(layer.name) == nullptr) {
      throw InputError(name_b,
                       "lacks " + quoted(layer.name) + " of " + name_a + "; compare images with the same layers");
    }
  }
  std::vector<LayerPair> pairs;
  for (const Layer& layer : b.layers) {
    const Layer* other = a.find(layer.name);
    if (other == nullptr) {
      throw InputError(name_a,
                       "lacks " + quoted(layer.name) + " of " + name_b + "; compare images with the same layers");
    }
    pairs.push_back(match_channels(*other, layer, name_a, name_b));
  }
  return pairs;
}

void check_finite(const Layer& layer, int width, const std::string& name) {
  const auto bad =
      std::find_if(layer.data.begin(), layer.data.end(), [](float value) { return !std::isfinite(value); });
  if (bad == layer.data.end()) return;
  const auto index = static_cast<std::size_t>(bad - layer.data.begin());
  const std::size_t pixel = index / layer.channels.size();
  const auto columns = static_cast<std::size_t>(width);
  throw InputError(name, std::string(std::isnan(*bad) ? "NaN" : "infinity") + " at pixel (" +
                             std::to_string(pixel % columns) + ", " + std::to_string(pixel / columns) + "), channel " +
                             layer.channels[index % layer.channels.size()] + " of " + quoted(layer.name) +
                             "; it cannot be compared");
}

LayerComparison compare_layer(const LayerPair& pair, std::size_t width) {
  const std::size_t channels = pair.b.channels.size();
  LayerComparison result;
  result.layer = pair.b.name;
  double squares = 0;
  double relative_squares = 0;
  double peak = -std::numeric_limits<double>::infinity();
  std::size_t count = 0;
  for (std::size_t i = 0; i < pair.b.data.size(); ++i) {
    const std::size_t pixel = i / channels;
    const std::size_t channel = i % channels;
    const float a = pair.a.data[pixel * channels + pair.channel_in_a[channel]];
    const float b = pair.b.data[i];
    if (result.identical && std::bit_cast<std::uint32_t>(a) != std::bit_cast<std::uint32_t>(b)) {
      result.identical = false;
      result.first = PixelDifference{static_cast<int>(pixel % width),
                                     static_cast<int>(pixel / width),
                                     pair.b.name,
                                     pair.b.channels[channel],
                                     a,
                                     b};
    }
    const double difference = double{a} - double{b};
    result.max_abs = std::max(result.max_abs, std::abs(difference));
    if (channels > 1 && pair.b.channels[channel] == "A") continue;
    squares += difference * difference;
    relative_squares += difference * difference / (double{b} * double{b} + kRelMseFloor);
    peak = std::max(peak, double{b});
    ++count;
  }
  result.rmse = std::sqrt(squares / static_cast<double>(count));
  result.rel_mse = relative_squares / static_cast<double>(count);
  if (squares == 0) {
    result.psnr_db = std::numeric_limits<double>::infinity();
  } else if (peak <= 0) {
    result.psnr_db = -std::numeric_limits<double>::infinity();
  } else {
    result.psnr_db = 20 * std::log10(peak / result.rmse);
  }
  return result;
}

std::size_t find_headline(const Image& b, const std::string& layer, const std::string& name_b) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < b.layers.size(); ++i) {
    if (b.layers[i].name == layer) return i;
    names.push_back(b.layers[i].name.empty() ? "\"\" (beauty)" : b.layers[i].name);
  }
  if (layer.empty() && b.layers.size() == 1) return 0;
  throw InputError(name_b, "has no " + (layer.empty() ? "beauty layer" : "layer \"" + layer + "\"") +
                               "; choose one of its layers: " + joined(names));
}

}  // namespace

ImageComparison compare_images(const Image& a, const Image& b, const std::string& name_a, const std::string& name_b,
                               const std::string& headline_layer) {
  const std::vector<LayerPair> pairs = match_layers(a, b, name_a, name_b);
  ImageComparison result;
  result.headline = find_headline(b, headline_layer, name_b);
  for (const LayerPair& pair : pairs) {
    check_finite(pair.a, a.width, name_a);
    check_finite(pair.b, b.width, name_b);
    result.layers.push_back(compare_layer(pair, static_cast<std::size_t>(b.width)));
    const LayerComparison& layer = result.layers.back();
    if (layer.identical) continue;
    result.identical = false;
    const auto position = [](const PixelDifference& at) { return std::tuple(at.y, at.x); };
    if (!result.first || position(*layer.first) < position(*result.first)) result.first = layer.first;
  }
  return result;
}

Image difference_image(const Image& a, const Image& b, const std::string& name_a, const std::string& name_b) {
  Image result;
  result.width = b.width;
  result.height = b.height;
  for (const LayerPair& pair : match_layers(a, b, name_a, name_b)) {
    const std::size_t channels = pair.b.channels.size();
    Layer layer{pair.b.name, pair.b.channels, std::vector<float>(pair.b.data.size())};
    for (std::size_t i = 0; i < layer.data.size(); ++i) {
      const float value = pair.a.data[i / channels * channels + pair.channel_in_a[i % channels]];
      layer.data[i] = std::abs(value - pair.b.data[i]);
    }
    result.layers.push_back(std::move(layer));
  }
  return result;
}

}  // namespace hemiray
