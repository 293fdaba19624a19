// One render on a device opened for it.
#include "tests/path/render_on_device.hpp"

namespace hemiray {

DeviceProfile profile_with_tail(std::uint32_t tail_paths) {
  DeviceProfile profile = profile_for(choose_device(""));
  profile.tail_paths = tail_paths;
  return profile;
}

RenderOptions same_options(const ReferenceOptions& options, EngineKind engine, bool strict) {
  RenderOptions render;
  render.engine = engine;
  render.width = options.width;
  render.height = options.height;
  render.spp = options.spp;
  render.depth = options.depth;
  render.seed = options.seed;
  render.strict = strict;
  return render;
}

Image render_on_device(const Scene& scene, const ReferenceOptions& options, EngineKind engine, bool strict,
                       std::uint32_t tail_paths) {
  Context context(choose_device(""), profile_with_tail(tail_paths));
  return render_scene(context, scene, same_options(options, engine, strict)).image;
}

}  // namespace hemiray
