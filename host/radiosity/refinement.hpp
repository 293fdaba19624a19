// Adaptive refinement: patches that light varies on are cut, and what that changes is computed again.
#pragma once

#include "host/radiosity/radiosity.hpp"
#include "host/radiosity/side_light.hpp"

namespace hemiray {

/// Refines mesh and solution of `result` in rounds of at most half as many patches again, up to
/// options.refine_patches: chooses patches (refine_choice.hpp), cuts them (refine_mesh.hpp), makes the parts' rows of
/// form factors, keeps the others' (refine_factors.hpp), and solves the whole refined system, for which the bound then
/// holds. `matrix` and `light`: of the mesh so far. Ends early where no jump exceeds twice what the solution's
/// tolerance allows, the solution has not converged, or it is interrupted; statistics.refinement says which. What is
/// kept after an interrupt is the last mesh that has a solution. Throws as refine_patch_mesh() and solve_radiosity()
/// do.
void refine_solution(Context& context, Parallel& parallel, AccelBuilder& builder, const FlatScene& flat,
                     const RadiosityOptions& options, const FactorOptions& factors, FactorMatrix matrix,
                     SideLight& light, Radiosity& result);

}  // namespace hemiray
