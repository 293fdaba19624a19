#include "host/path/megakernel.hpp"

#include "host/path/wavefront.hpp"

namespace hemiray {

MegakernelEngine::MegakernelEngine(Context& context, const ProgramOptions& options, std::uint32_t slots, int depth)
    : context_(&context),
      slots_(slots),
      program_(context, "megakernel", {"path/megakernel.cl", "film/accumulate.cl"}, options),
      sums_(context, options.features, slots),
      branches_(context, options, slots, depth),
      ray_counts_(context, "ray_counts", slots) {}

RayCounts MegakernelEngine::trace(shared::RenderParams params, std::uint32_t count, const Arguments& given) {
  params.slot_count = slots_;
  launch(*context_, program_.kernel("path_megakernel"), count,
         arguments(given, sums_.as_arguments(), branches_.as_arguments(), arg("ray_counts", ray_counts_),
                   arg("count", count), arg("params", params)));
  RayCounts total;
  for (const shared::uint2& rays : ray_counts_.read(0, count)) {
    total.closest += rays.x;
    total.shadow += rays.y;
  }
  return total;
}

std::unique_ptr<PathEngine> make_engine(EngineKind kind, Context& context, Parallel& parallel,
                                        const ProgramOptions& options, std::uint32_t slots, int depth,
                                        const WaveTracing& tracing) {
  if (kind == EngineKind::megakernel) {
    return std::make_unique<MegakernelEngine>(context, options, slots, depth);
  }
  return std::make_unique<WavefrontEngine>(context, parallel, options, slots, depth, tracing);
}

}  // namespace hemiray
