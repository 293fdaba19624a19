// The rays that are measured: what a renderer asks of a scene, as arrays.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "host/bench/procedural_scenes.hpp"
#include "shared/bvh_types.h"

namespace hemiray::bench {

/// Rays of one kind. Their number is a multiple of 64.
struct RaySet {
  std::string name;
  std::vector<shared::QueryRay> rays;
  bool any_hit = false;        ///< the question is whether something is met, not what
  bool common_origin = false;  ///< each 64 consecutive rays start at one point: packets may trace them
};

/// Answers closest hits, in the rays' order.
using ClosestHits = std::function<std::vector<shared::QueryHit>(std::span<const shared::QueryRay>)>;

inline constexpr std::uint32_t kDefaultResolution = 1024;

/// Five sets, from `resolution` (a multiple of 32, 32 to 4096) on a side of the picture:
/// - primary: through the pixels' centres, in tiles of 4 x 4 pixels, tile rows from left to right: 16 consecutive rays
///   are a tile, 64 are neighbours; common origin.
/// - shadow: from the primary rays' hits, 1 mm off the surface, to the light; t_max 0.999 of the way; any hit.
/// - shadow_from_light: the same pairs from the light; common origin; any hit.
/// - diffuse: from the same points, cosine-distributed about the normal.
/// - hemicube: from 8 of those points all around the normal: a face of n x n pixels on top and four sides of n x n/2,
///   n = resolution / 4, in tiles as above; common origin.
/// Rays that miss the scene start no others, so the three sets in the middle may be shorter. Throws InputError if the
/// camera sees fewer than 64 pixels of the scene, or for another resolution.
std::vector<RaySet> make_ray_sets(const BenchScene& scene, std::uint32_t resolution, const ClosestHits& closest_hits);

/// The first of them alone.
RaySet primary_rays(const View& view, std::uint32_t resolution);

}  // namespace hemiray::bench
