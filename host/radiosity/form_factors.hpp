// Form factors for the sides that light reaches, by any of the methods, with what is known about their errors.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "host/radiosity/area_errors.hpp"
#include "host/radiosity/enforce.hpp"
#include "host/radiosity/guards.hpp"
#include "host/radiosity/hemicubes.hpp"

namespace hemiray {

/// hemicube: what rays through a cube's cells meet. analytic: pair by pair, exact with nothing in the way, times
/// visibility by rays (small hemicubes still say which sides light reaches). hybrid: the same, hemicubes checked
/// against it, and closed rows made to sum to one.
enum class FormFactors { hemicube, analytic, hybrid };

struct FactorOptions {
  FormFactors method = FormFactors::hybrid;
  HemicubeOptions hemicube;                             ///< of hybrid and analytic: kReachResolution serves
  VisibilityOptions visibility;                         ///< of hybrid and analytic
  FactorPrecision precision = FactorPrecision::single;  ///< in which they are kept, once they are made
};

/// Cells along an edge of hemicubes that only say which sides light reaches.
inline constexpr std::uint32_t kReachResolution = 16;

/// Means over the rows, of their sums: what may be wrong with F.
struct FactorErrors {
  double geometry = 0.0;  ///< bound of the quadrature's error
  double sampling = 0.0;  ///< standard errors of rays of partly hidden pairs, as if all one way
  double closure = 0.0;   ///< |1 - sum F| of closed rows: also what a ray a pair takes for seen or hidden wrongly
  double partial = 0.0;   ///< share of partly hidden pairs
};

struct FactorReport {
  std::uint64_t cube_rays = 0, pair_rays = 0, sample_rays = 0;
  std::uint64_t pairs = 0;  ///< that exchange light, each counted once
  std::uint64_t near_pairs = 0, partial_pairs = 0;
  double cubes_ms = 0.0, visibility_ms = 0.0, sample_ms = 0.0, pairs_ms = 0.0, enforce_ms = 0.0;
  FactorErrors row_errors;                  ///< of analytic and hybrid
  std::vector<ErrorSplit> exchange_errors;  ///< of the same, between areas, where these are given (AreaErrors)
  std::optional<Violations> violations;     ///< of the hemicubes, in hybrid
  std::optional<Enforcement> enforcement;   ///< of analytic (measured only) and hybrid
  bool interrupted = false;
};

/// Rows of all sides that light from `sources` can reach. `on_progress` gets the fraction done; returning false ends
/// early, what is there is returned. Throws InputError for options out of range, DeviceError.
FactorMatrix make_form_factors(Context& context, Parallel& parallel, const PatchMesh& mesh, Hemicubes& hemicubes,
                               std::span<const std::uint32_t> sources, const FactorOptions& options,
                               FactorReport& report, const std::function<bool(double)>& on_progress = {});

/// The same for given sides, ascending. `areas`: those that the report tells errors of.
FactorMatrix make_form_factors_of(Context& context, Parallel& parallel, const PatchMesh& mesh, Hemicubes& hemicubes,
                                  std::span<const std::uint32_t> sides, const FactorOptions& options,
                                  FactorReport& report, const std::function<bool(double)>& on_progress = {},
                                  const FactorGroups* areas = nullptr);

}  // namespace hemiray
