// Form factors by hemicubes, for the sides that light can reach.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "host/bvh/accel.hpp"
#include "host/radiosity/factor_matrix.hpp"
#include "host/radiosity/hemicube_raster.hpp"
#include "host/radiosity/patch_mesh.hpp"

namespace hemiray {

/// What finds the patch that a cell shows: a ray through it, or all patches drawn into an item buffer. They differ at
/// edges only, by rounding. Which is faster: bench/README.md.
enum class CubeView { rays, raster };

struct HemicubeOptions {
  CubeView view = CubeView::rays;
  std::uint32_t resolution = 64;  ///< cells along an edge of the top: even, 8 to 1024
  std::uint32_t divisions = 1;    ///< sample points a patch: the square of this, 1 to 16
  bool turned = true;             ///< each cube about its normal by an angle of its own, against aliasing
  bool jittered = false;          ///< rays through random points of the cells; not of a raster
  std::uint32_t seed = 0;
  std::uint64_t batch_bytes = std::uint64_t{64} << 20U;  ///< for what the rays of a batch see
};

/// Throws InputError for options out of range.
void check_hemicube_options(const HemicubeOptions& options);

/// A mesh on the device with its tree, and the kernels that look from its sides. The Context, the builder and the mesh
/// must outlive it.
class Hemicubes {
 public:
  Hemicubes(Context& context, Parallel& parallel, AccelBuilder& builder, const PatchMesh& mesh,
            const HemicubeOptions& options);

  /// Rows of these sides, as further blocks of `matrix`.
  /// `on_batch` gets the rows done; returning false ends it early.
  void add_rows(std::span<const std::uint32_t> sides, FactorMatrix& matrix,
                const std::function<bool(std::uint64_t)>& on_batch = {});

  /// Rows of all sides that light from `sources` can reach: those that emit, what they see, what that sees. A face is
  /// taken whole, so that no patch of it stays out for being missed by every ray. `on_progress` gets rows done and
  /// known to be wanted, those among them; returning false ends it early.
  FactorMatrix rows_reached_from(std::span<const std::uint32_t> sources,
                                 const std::function<bool(std::uint64_t, std::uint64_t)>& on_progress = {});

  /// The same as further blocks of `matrix`, whose blocks, if it has any, are the first that this would make. Throws
  /// InputError where they are not.
  void add_rows_reached_from(std::span<const std::uint32_t> sources, FactorMatrix& matrix,
                             const std::function<bool(std::uint64_t, std::uint64_t)>& on_progress = {});

  /// What the cells of these sides' hemicubes show, numbered as in shared/radiosity_types.h: a side or HR_NO_SIDE,
  /// until the next call of anything here. At most rows_a_batch() sides.
  const Buffer<std::uint32_t>& look_from(std::span<const std::uint32_t> sides);
  [[nodiscard]] std::uint32_t rows_a_batch() const;
  /// Of a side, all its hemicubes.
  [[nodiscard]] std::uint64_t cells() const;

  /// Or cells drawn.
  [[nodiscard]] std::uint64_t rays_traced() const { return rays_; }
  [[nodiscard]] std::uint64_t rows_made() const { return rows_made_; }
  [[nodiscard]] std::uint64_t entries_made() const { return entries_; }
  [[nodiscard]] const DeviceScene& scene() const { return scene_; }
  [[nodiscard]] const Accel& accel() const { return accel_; }

 private:
  void take_rows(std::span<const std::uint32_t> sides, const FactorBlock& block);
  [[nodiscard]] shared::HemicubeParams params(std::size_t rows) const;
  void look(const Buffer<std::uint32_t>& rows, const shared::HemicubeParams& cube);
  void trace(const Buffer<std::uint32_t>& rows, const shared::HemicubeParams& cube);

  Context* context_;
  Parallel* parallel_;
  const PatchMesh* mesh_;
  HemicubeOptions options_;
  DeviceScene scene_;
  Accel accel_;
  std::optional<HemicubeRaster> raster_;  ///< or
  std::optional<Program> trace_;
  Program rows_;
  Buffer<shared::float4> normals_;
  Buffer<std::uint32_t> delta_;  ///< of cells, in units of 2^-HR_CELL_UNITS_LOG2
  Buffer<std::uint32_t> seen_, reached_;
  Buffer<std::uint64_t> sums_;
  std::uint32_t items_;  ///< of the kernels that sum rows
  std::uint64_t rays_ = 0, rows_made_ = 0, entries_ = 0;
};

}  // namespace hemiray
