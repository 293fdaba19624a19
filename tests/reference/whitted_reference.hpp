// An independent, naive CPU oracle of the Whitted ray tracer: double precision, recursive, one ray after the other.
#pragma once

#include "host/base/image.hpp"
#include "host/scene/scene.hpp"

namespace hemiray {

struct ReferenceOptions {
  int width = 32;   ///< [pixels], > 0
  int height = 32;  ///< [pixels], > 0
  int spp = 1;      ///< samples per pixel, > 0
  int depth = 8;    ///< maximum number of bounces along a path, >= 0
  std::uint32_t seed = 0;
};

/// Renders a valid scene (see validate_scene). Layers: "" {R,G,B,A}, "depth" {Z}, "normal" {X,Y,Z}, "albedo" {R,G,B},
/// "id" {id}, "direct", "reflection", "refraction" {R,G,B}. Beauty = direct + reflection + refraction, and A is the
/// share of samples that hit; depth (along the ray [m], 0 for a miss), normal, albedo and id are those of sample 0.
/// Throws InputError for a size, sample count or depth out of range.
Image render_reference(const Scene& scene, const ReferenceOptions& options);

}  // namespace hemiray
