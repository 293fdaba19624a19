// Where patches meet: by places, since neighbours of different objects or shading have vertices of their own.
#pragma once

#include <cstdint>
#include <vector>

#include "host/radiosity/patch_mesh.hpp"

namespace hemiray {

/// Numbers of the places of vertices, by vertex: those at one place have one number. -0 is 0.
std::vector<std::uint32_t> number_places(const FlatScene& flat);

/// Of the angle between patches' normals.
double cosine_of(const shared::float4& a, const shared::float4& b);

/// Edge k of patch i, from its corner k to the next, is number of_patches[3 i + k].
struct MeshEdges {
  explicit MeshEdges(const PatchMesh& mesh);

  std::vector<std::uint32_t> of_patches;
  std::vector<double> lengths2;           ///< of the edges [m^2]
  std::vector<std::uint32_t> neighbours;  ///< 3 a patch: the other one at this edge; HR_NO_SIDE: none, or several
};

}  // namespace hemiray
