// How far an image is from its reference.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "host/base/image.hpp"

namespace hemiray {

/// Added to B² in relMSE, so that black reference pixels do not divide by zero.
inline constexpr double kRelMseFloor = 0.01;

/// A value that differs in its bits.
struct PixelDifference {
  int x = 0;  ///< from the left
  int y = 0;  ///< from the top
  std::string layer;
  std::string channel;
  float a = 0;
  float b = 0;
};

/// One layer of A against the same layer of B, the reference. rmse, rel_mse and psnr_db are over all values but alpha
/// (channel "A" beside others), which is the same everywhere in most images; the others are over all values.
struct LayerComparison {
  std::string layer;
  double rmse = 0;        ///< sqrt(mean((A - B)²)), in the layer's unit
  double rel_mse = 0;     ///< mean((A - B)² / (B² + kRelMseFloor))
  double psnr_db = 0;     ///< 20 log10(max(B) / rmse); +infinity where rmse is 0, -infinity where max(B) <= 0
  double max_abs = 0;     ///< max |A - B|
  bool identical = true;  ///< the same bits (+0 and -0 differ)
  std::optional<PixelDifference> first;  ///< in the order of rows, then columns, then channels
};

struct ImageComparison {
  std::vector<LayerComparison> layers;   ///< in B's order
  std::size_t headline = 0;              ///< index of the layer that stands for the image
  bool identical = true;                 ///< all layers
  std::optional<PixelDifference> first;  ///< over all layers, in the order of rows, then columns, then layers
};

/// Compares A with the reference B, layer by layer; layers and channels are matched by name, their order is no matter,
/// metadata are not compared. The headline is `headline_layer`; where that is "" and the images have no beauty layer,
/// it is their only layer. name_a and name_b stand for the images in errors. Throws InputError where sizes, layers or
/// channels do not match, a value is NaN or infinite, the headline layer is missing, or there is more than one
/// candidate for it.
[[nodiscard]] ImageComparison compare_images(const Image& a, const Image& b, const std::string& name_a,
                                             const std::string& name_b, const std::string& headline_layer = "");

/// |A - B| in every layer of B. Throws as compare_images does where the images do not match.
[[nodiscard]] Image difference_image(const Image& a, const Image& b, const std::string& name_a,
                                     const std::string& name_b);

}  // namespace hemiray
