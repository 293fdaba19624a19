// Which pairs of sides see each other: wholly, not at all, or in part, and then how much.
#pragma once

#include <cstdint>
#include <functional>

#include "host/bvh/accel.hpp"
#include "host/radiosity/pair_sides.hpp"

namespace hemiray {

/// Which pairs get rays of their own: those that rays between all centroids find to be partly hidden, or all whose
/// shaft (the hull of both sides) holds something, which misses none and takes far longer.
enum class PairSearch { rays, shafts };

struct VisibilityOptions {
  PairSearch search = PairSearch::rays;
  std::uint32_t few = 16;     ///< rays of each pair with something between, in whole vectors; at least 1
  std::uint32_t many = 1024;  ///< at most, fourfold each time; at least `few`
  double accuracy = 0.001;    ///< a pair gets more rays while one brings the two rows nearer by more than this / rows
  std::uint32_t seed = 0;
};

/// The same by shafts, and ten times as accurate: what pairs that were not found cost is no longer there to cover it.
inline VisibilityOptions by_shafts(VisibilityOptions options) {
  options.search = PairSearch::shafts;
  options.accuracy *= 0.1;
  return options;
}

struct PairVisibility {
  Buffer<std::uint32_t> visible, partial;  ///< bit matrices, stride bits a row: i sees all of j; some of it
  Buffer<std::uint32_t> starts, columns;   ///< partial pairs i < j, by number
  Buffer<float> shares, errors;            ///< of their exchange what gets through; its standard error
  std::uint32_t pairs = 0;                 ///< in the list: partial ones, and with shafts all that face each other
  bool misses_some = true;                 ///< pairs may be taken for wholly seen or hidden that are not
  std::uint32_t partly_hidden = 0;         ///< those of the list that have something between
  std::uint64_t rays = 0, pair_rays = 0;   ///< in all; of these, one a pair from centroid to centroid
  double trace_ms = 0.0, sample_ms = 0.0;
};

/// By rays: a ray from centroid to centroid of each pair that face each other, of those with a side that rows are
/// wanted of. A pair counts as partly hidden if another one of sides next to it (sharing an edge) got the other answer,
/// if its sides are close for their size, or face each other only in part; then rays tested against what lies in its
/// shaft tell how much is seen. By shafts: every pair that face each other is looked at so. Rays meet the mesh's
/// blockers. `on_progress` gets the fraction done; returning false throws nothing and leaves the rest unseen. Throws
/// DeviceError, also where bit matrices exceed the largest allocation, and InputError for too many sides for shafts.
PairVisibility find_visibility(Context& context, Parallel& parallel, const PatchMesh& mesh, const PairSides& sides,
                               const VisibilityOptions& options, const std::function<bool(double)>& on_progress = {});

}  // namespace hemiray
