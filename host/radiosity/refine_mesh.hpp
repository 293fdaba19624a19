// A mesh of patches, some of them cut further.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "host/radiosity/patch_mesh.hpp"

namespace hemiray {

struct RefinedMesh {
  PatchMesh mesh;                      ///< patches that are not cut keep their numbers
  std::vector<std::uint32_t> parents;  ///< of its patches: what they are part of, or were, in the mesh before
  std::vector<std::uint32_t> parts;    ///< patches that are new, ascending
  std::uint32_t cut = 0;               ///< patches that are gone
};

/// Halves all edges of as many of the patches, the first ones, as make no more than `most` patches in all. A
/// neighbour's longest edge is halved, too, where another one of its edges is, so that there are no T-junctions and
/// angles do not degenerate (Rivara 1984). Parts lie on their patch, of a round surface too: what they are tessellated
/// to, and what hides what, stays. Edges between floats that are next to each other stay whole. Throws InputError as
/// read_patch_materials() does.
RefinedMesh refine_patch_mesh(const PatchMesh& mesh, std::span<const std::uint32_t> patches, std::uint32_t most);

}  // namespace hemiray
