// One render on a device opened for it.
#include "tests/path/render_on_device.hpp"

#include "host/path/render.hpp"

namespace hemiray {

Image render_on_device(const Scene& scene, const ReferenceOptions& options, EngineKind engine, bool strict) {
  RenderOptions render;
  render.engine = engine;
  render.width = options.width;
  render.height = options.height;
  render.spp = options.spp;
  render.depth = options.depth;
  render.seed = options.seed;
  render.strict = strict;
  Context context(choose_device(""));
  return render_scene(context, scene, render).image;
}

}  // namespace hemiray
