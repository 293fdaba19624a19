#include "host/path/device_render.hpp"

namespace hemiray {
namespace {

void note_program(const Context& context, RenderStatistics& statistics, const Program& program) {
  const bool driver_had_it = context.profile().has_own_cache && context.kernels_compiled() == 0;
  const bool cached = program.from_cache() || driver_had_it;
  statistics.programs.push_back({program.name(), program.kernel_count(), program.build_ms(), cached});
}

ProgramOptions engine_options(const Accel& accel, const RenderSetup& setup) {
  ProgramOptions options = accel.program_options(setup.features, setup.options.strict, setup.options.double_precision);
  if (!setup.options.smooth_terminator) options.defines += " -DHR_HARD_TERMINATOR=1";
  return options;
}

}  // namespace

DeviceRender::DeviceRender(Context& context, const RenderSetup& setup)
    : context_(&context),
      slots_(setup.slots(context.profile())),
      predicted_bytes_(setup.predicted_bytes(context.profile())),
      upload_start_(steady_ms()),
      scene_(context, setup.flat, setup.features),
      upload_ms_(setup.flatten_ms + steady_ms() - upload_start_),
      parallel_(context),
      builder_(context, parallel_),
      accel_(builder_, scene_, setup.options.accel),
      engine_(make_engine(setup.options.engine, context, parallel_, engine_options(accel_, setup), slots_, setup.depth,
                          choose_tracing(setup.options.rays, setup.wave_facts(), accel_, context.profile()))),
      scene_arguments_(arguments(scene_.shading_arguments(), accel_.tree_arguments())),
      params_(setup.params(scene_)) {}

RayCounts DeviceRender::trace(std::uint32_t pass, std::uint32_t first_pixel, std::uint32_t count,
                              const Arguments& aov) {
  params_.sample = pass;
  params_.first_pixel = first_pixel;
  return engine_->trace(params_, count, arguments(scene_arguments_, aov));
}

void DeviceRender::describe(RenderStatistics& statistics) {
  statistics.features = scene_.features();
  statistics.accel = accel_.statistics();
  statistics.planes = scene_.plane_count();
  statistics.lights = scene_.light_count();
  statistics.emitters = scene_.emitter_count();
  statistics.uncertain_roots = scene_.uncertain_roots();
  statistics.upload_ms = upload_ms_;
  statistics.predicted_device_bytes = predicted_bytes_;
  statistics.stages = context_->profiler().stages();
  statistics.peak_device_bytes = context_->peak_bytes();
  statistics.launch_compile_ms = context_->launch_compile_ms();
  statistics.kernels_compiled = context_->kernels_compiled();
  note_program(*context_, statistics, parallel_.program());
  for (const Program* program : builder_.programs()) note_program(*context_, statistics, *program);
  note_program(*context_, statistics, engine_->program());
}

}  // namespace hemiray
