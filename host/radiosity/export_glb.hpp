// A radiosity solution for any glTF viewer.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "host/radiosity/display.hpp"

namespace hemiray {

/// What the file says of the mesh.
struct GlbFacts {
  double exposure = 0.0;  ///< factor by which radiosities were multiplied for COLOR_0
};

/// A binary glTF 2.0 file of the solution: one mesh, unlit (KHR_materials_unlit), COLOR_0 the exposed radiosity of each
/// corner, linear, in [0, 1], as the specification wants, and _RADIOSITY the radiosity itself [W/m^2], float. Sides of
/// triangles that light does not come to are left out; backs are turned round. `exposure` 0: such that the mean
/// radiosity of what is lit, without what emits, becomes 0.4. Throws InputError where nothing is lit.
std::string solution_as_glb(const PatchMesh& mesh, const std::vector<std::array<double, 3>>& irradiance,
                            const DisplayOptions& options, double exposure, GlbFacts& facts);

}  // namespace hemiray
