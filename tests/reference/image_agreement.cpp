// Counts outliers and sums errors.
#include "tests/reference/image_agreement.hpp"

#include <cmath>
#include <stdexcept>

namespace hemiray::reference {

namespace {

constexpr double kOutlierFloor = 0.1;
constexpr double kRelMseFloor = 0.01;

LayerAgreement compare_layer(const Layer& layer, const Layer& reference, std::size_t pixels) {
  const std::size_t channels = reference.channels.size();
  if (layer.data.size() != pixels * layer.channels.size() || layer.channels.size() < channels) {
    throw std::runtime_error("layer '" + reference.name + "' has other channels than the reference");
  }
  LayerAgreement result;
  result.layer = reference.name;
  std::size_t outliers = 0;
  for (std::size_t p = 0; p < pixels; ++p) {
    bool outlier = false;
    double error = 0.0;
    for (std::size_t c = 0; c < channels; ++c) {
      const double a = layer.data[p * layer.channels.size() + c];
      const double b = reference.data[p * channels + c];
      if (!std::isfinite(a) || !std::isfinite(b)) throw std::runtime_error("not finite: layer '" + layer.name + "'");
      outlier = outlier || std::abs(a - b) > kOutlier * (std::abs(b) + kOutlierFloor);
      error += (a - b) * (a - b) / (b * b + kRelMseFloor);
    }
    if (outlier) {
      ++outliers;
    } else {
      result.rel_mse += error;
    }
  }
  result.outlier_share = static_cast<double>(outliers) / static_cast<double>(pixels);
  if (outliers < pixels) result.rel_mse /= static_cast<double>((pixels - outliers) * channels);
  return result;
}

}  // namespace

std::vector<LayerAgreement> compare_layers(const Image& image, const Image& reference) {
  if (image.width != reference.width || image.height != reference.height) {
    throw std::runtime_error("the images differ in size");
  }
  std::vector<LayerAgreement> result;
  for (const Layer& layer : reference.layers) {
    const Layer* other = image.find(layer.name);
    if (other == nullptr) throw std::runtime_error("layer '" + layer.name + "' is missing");
    result.push_back(compare_layer(*other, layer, reference.pixel_count()));
  }
  return result;
}

}  // namespace hemiray::reference
