// One render on a device opened for it.
#include "tests/path/render_on_device.hpp"

#include "host/path/render.hpp"

namespace hemiray {

DeviceProfile profile_with_tail(std::uint32_t tail_paths) {
  DeviceProfile profile = profile_for(choose_device(""));
  profile.tail_paths = tail_paths;
  return profile;
}

Image render_on_device(const Scene& scene, const ReferenceOptions& options, EngineKind engine, bool strict,
                       std::uint32_t tail_paths) {
  RenderOptions render;
  render.engine = engine;
  render.width = options.width;
  render.height = options.height;
  render.spp = options.spp;
  render.depth = options.depth;
  render.seed = options.seed;
  render.strict = strict;
  Context context(choose_device(""), profile_with_tail(tail_paths));
  return render_scene(context, scene, render).image;
}

}  // namespace hemiray
