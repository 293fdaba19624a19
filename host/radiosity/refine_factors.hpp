// Form factors of a refined mesh: of the parts' rows anew, of all others what is left.
#pragma once

#include <cstdint>
#include <functional>

#include "host/radiosity/form_factors.hpp"
#include "host/radiosity/refine_mesh.hpp"

namespace hemiray {

struct RefinedFactors {
  FactorMatrix matrix;
  std::uint64_t made_rows = 0;  ///< of parts; the others' are kept
  std::uint64_t rays = 0;
  bool interrupted = false;  ///< `matrix` is not whole
};

/// `old`: of the mesh before, by the same method. `hemicubes`: of the refined mesh. Parts of sides that had a row get
/// one, as do parts that emit. What other rows had for a cut patch goes to its parts: by hemicubes, each row's own
/// factor is shared out by what the parts see of the row (A_e F_ei; by area, where they see nothing), so that its sum
/// stays; pair by pair, factors follow from the parts' by reciprocity, to the rounding of floats, and in hybrid rows
/// that were closed are closed again. `on_progress` gets the fraction done; returning false ends it. Throws
/// DeviceError.
RefinedFactors refine_factors(Context& context, Parallel& parallel, Hemicubes& hemicubes, const FactorMatrix& old,
                              const RefinedMesh& refined, const FactorOptions& options,
                              const std::function<bool(double)>& on_progress = {});

}  // namespace hemiray
