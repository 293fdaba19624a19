// A radiosity solution as a scene that the path tracer shows.
#pragma once

#include <array>
#include <vector>

#include "host/radiosity/patch_mesh.hpp"

namespace hemiray {

struct DisplayOptions {
  bool smooth = true;        ///< irradiance interpolated between vertices; else constant on each patch
  double crease_deg = 20.0;  ///< patches that meet at a larger angle do not share a vertex's irradiance
};

/// The corners' irradiance [W/m^2] of every side, 3 a side: the mean, by area, of the patches around the vertex that
/// lie in the same smooth surface, on the same side. Irradiance is interpolated, not radiosity, so reflectance does not
/// bleed from one patch into another.
std::vector<std::array<float, 3>> corner_irradiance(const PatchMesh& mesh,
                                                    const std::vector<std::array<double, 3>>& irradiance,
                                                    const DisplayOptions& options);

/// The mesh with that irradiance in patch_light, and no light: what a surface sends is emission + kd H / pi +
/// translucency H' / pi, H' on its other side, with its textures, mirrors and glass on top.
FlatScene lit_patches(const PatchMesh& mesh, const std::vector<std::array<double, 3>>& irradiance,
                      const DisplayOptions& options = {});

/// The same, but the path tracer looks from every diffuse hit with `rays` rays for what other patches send there (a
/// final gather), and samples the lights of `scene`, which the mesh was cut from, as it does without radiosity: shadows
/// and corners are as sharp as they are, however coarse the mesh. Highlights of the lights are there, too. `rays` >= 1.
FlatScene gathered_patches(const FlatScene& scene, const PatchMesh& mesh,
                           const std::vector<std::array<double, 3>>& irradiance, std::uint32_t rays,
                           const DisplayOptions& options = {});

}  // namespace hemiray
