// What an engine leaves for the film: radiance of each slot's pixel sample, by the kind of its first bounce.
#pragma once

#include <cstdint>

#include "host/gpu/buffer.hpp"
#include "host/gpu/program.hpp"
#include "host/scene/features.hpp"
#include "shared/scalar.h"

namespace hemiray {

struct PathSums {
  Buffer<shared::float4> direct;      ///< rgb [W/m^2/sr], w = coverage
  Buffer<shared::float4> reflection;  ///< empty where the feature is off
  Buffer<shared::float4> refraction;

  PathSums(Context& context, std::uint32_t features, std::uint32_t slots) : direct(context, "path_sum_direct", slots) {
    if (has_feature(features, HR_FEATURE_REFLECTION)) reflection = {context, "path_sum_reflection", slots};
    if (has_feature(features, HR_FEATURE_REFRACTION)) refraction = {context, "path_sum_refraction", slots};
  }

  [[nodiscard]] Arguments as_arguments() const {
    Arguments all = arguments(arg("path_sum_direct", direct));
    if (!reflection.name().empty()) all.push_back(arg("path_sum_reflection", reflection));
    if (!refraction.name().empty()) all.push_back(arg("path_sum_refraction", refraction));
    return all;
  }
};

}  // namespace hemiray
