// A radiosity solution as it is shown, for tests that compare it with the path-traced truth.
#pragma once

#include "host/path/render.hpp"
#include "host/radiosity/display.hpp"
#include "host/radiosity/radiosity.hpp"
#include "tests/reference/whitted_reference.hpp"

namespace hemiray::test {

inline Image show_patches(Context& context, const Scene& scene, const FlatScene& patches,
                          const ReferenceOptions& options, EngineKind engine = EngineKind::wavefront,
                          bool strict = false) {
  RenderOptions render;
  render.engine = engine;
  render.strict = strict;
  render.width = options.width;
  render.height = options.height;
  render.spp = options.spp;
  render.depth = options.depth;
  render.seed = options.seed;
  render.patches = &patches;
  return render_scene(context, scene, render).image;
}

}  // namespace hemiray::test
