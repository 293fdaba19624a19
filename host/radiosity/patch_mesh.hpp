// The mesh that radiosity is solved on: triangles, each a patch with two sides.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "host/scene/flat_scene.hpp"
#include "shared/radiosity_types.h"

namespace hemiray {

/// How finely surfaces are cut. Every edge longer than the target is halved, so neighbours that share an edge cut it
/// alike, without T-junctions.
struct PatchOptions {
  double edge_m = 0.0;           ///< target length of edges [m]; 0: as short as `patches` allows
  std::uint32_t patches = 4000;  ///< budget, if there is no target: at most so many, unless the scene itself has more
  double chord_m = 0.0;  ///< largest distance of a tessellated round surface from the true one [m]; 0: 1 % of its
                         ///< radius
};

/// Side 2 i is the front of triangle i of `flat`, side 2 i + 1 its back.
struct PatchMesh {
  FlatScene flat;                       ///< triangles only, each a patch; materials as in the scene
  std::vector<shared::float4> normals;  ///< of the triangles: unit, to the front; w = area [m^2]
  std::vector<std::uint32_t> faces;     ///< of the triangles: what they were cut from, numbered from 0
  std::uint32_t face_count = 0;
  /// Few triangles that hide what these hide: flat ones of the scene uncut, with vertices of `flat`.
  std::vector<shared::uint4> blockers;
  std::vector<std::uint32_t> blocker_of;      ///< of the triangles: the one that each lies on
  std::vector<shared::float4> reflectance;    ///< of the sides: rho, rgb; w = the largest of the three
  std::vector<shared::float4> transmittance;  ///< of the sides: tau, rgb; w = 0
  std::vector<shared::float4> emission;       ///< of the sides: E = pi L, rgb [W/m^2]; w = 1
  double chord_m = 0.0;                       ///< largest distance of a tessellated surface from the true one [m]
  double edge_m = 0.0;                        ///< longest edge [m]

  [[nodiscard]] std::uint32_t patch_count() const { return static_cast<std::uint32_t>(flat.triangles.size()); }
  [[nodiscard]] std::uint32_t side_count() const { return 2 * patch_count(); }
};

/// Cuts the scene's surfaces into patches and gives their sides what the materials say at the patches' middles.
/// Throws InputError for a surface that cannot be cut (a plane has no end; quadrics and implicit surfaces), a scene
/// without surfaces, or a patch that reflects everything (rho >= 1), which is named.
PatchMesh make_patch_mesh(const FlatScene& flat, const PatchOptions& options);

/// Lambert's law holds on average only: the mean of a side's reflectance and emission over the patch.
void read_patch_materials(const FlatScene& flat, PatchMesh& mesh);

}  // namespace hemiray
