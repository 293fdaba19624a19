// Which effects a scene calls for.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "host/scene/flat_scene.hpp"
#include "shared/features.h"

namespace hemiray {

/// The effect mask (HR_FEATURE_* bits): what is in the scene and can be seen with `depth` bounces. Kernels, buffers and
/// launches are specialised to it.
std::uint32_t features_of(const Scene& scene, const FlatScene& flat, int depth);

/// The part of it that the triangles call for: whether there are any, and whether more than one in 16 is thin, of an
/// aspect of over 100. Then kernels find the distance of thin ones exactly, which costs time.
std::uint32_t triangle_features(const FlatScene& flat);

/// Is `feature` (a bit, or HR_FEATURE_ALWAYS) on in the mask?
constexpr bool has_feature(std::uint32_t features, std::uint32_t feature) {
  return feature == HR_FEATURE_ALWAYS || (features & feature) != 0;
}

/// Names of the bits set, lower case with dashes, in bit order.
std::vector<std::string> feature_names(std::uint32_t features);

}  // namespace hemiray
