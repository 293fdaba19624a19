// How far an image agrees with the reference: pixels that differ outright, and the error of all others.
#pragma once

#include <string>
#include <vector>

#include "host/base/image.hpp"

namespace hemiray::reference {

/// Result for one layer.
struct LayerAgreement {
  std::string layer;
  double outlier_share = 0.0;  ///< pixels with a channel off by more than kOutlier, over all pixels
  double rel_mse = 0.0;        ///< mean of (a - b)^2 / (b^2 + 0.01) over the other pixels' channels
};

/// A pixel is an outlier where a channel is off by more than this, relative to |reference| + 0.1.
inline constexpr double kOutlier = 0.01;

/// Compares all layers of the reference. Throws std::runtime_error where sizes, layers or channel counts do not match
/// or a value is not finite.
std::vector<LayerAgreement> compare_layers(const Image& image, const Image& reference);

}  // namespace hemiray::reference
