// A path engine traces one pixel sample a slot. Two twins: wavefront and megakernel.
#pragma once

#include <cstdint>
#include <memory>

#include "host/bvh/accel.hpp"
#include "host/gpu/parallel.hpp"
#include "host/path/film.hpp"
#include "host/path/path_sums.hpp"
#include "host/path/wave_tracing.hpp"
#include "host/scene/device_scene.hpp"
#include "shared/params.h"

namespace hemiray {

enum class EngineKind { wavefront, megakernel };

/// Rays traced: closest-hit (camera, reflected, refracted) and shadow.
struct RayCounts {
  std::uint64_t closest = 0;
  std::uint64_t shadow = 0;
};

class PathEngine {
 public:
  PathEngine() = default;
  PathEngine(const PathEngine&) = delete;
  PathEngine& operator=(const PathEngine&) = delete;
  PathEngine(PathEngine&&) = delete;
  PathEngine& operator=(PathEngine&&) = delete;
  virtual ~PathEngine() = default;

  /// Traces sample params.sample of pixels [params.first_pixel, + count) to the end; `arguments` are the scene's, the
  /// tree's and the film's. Results are in sums(). Throws DeviceError.
  virtual RayCounts trace(shared::RenderParams params, std::uint32_t count, const Arguments& arguments) = 0;

  [[nodiscard]] virtual const PathSums& sums() const = 0;
  /// The engine's kernels; film_accumulate is among them.
  [[nodiscard]] virtual Program& program() = 0;
};

/// `slots` paths in flight, each with at most `depth` pending branches; `options` are the tree's
/// (Accel::program_options). The megakernel traces single rays whatever `tracing` says.
std::unique_ptr<PathEngine> make_engine(EngineKind kind, Context& context, Parallel& parallel,
                                        const ProgramOptions& options, std::uint32_t slots, int depth,
                                        const WaveTracing& tracing = {});

}  // namespace hemiray
