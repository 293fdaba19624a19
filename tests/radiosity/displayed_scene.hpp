// A radiosity solution as it is shown, for tests that compare it with the path-traced truth.
#pragma once

#include "host/radiosity/display.hpp"
#include "host/radiosity/radiosity.hpp"
#include "tests/path/render_on_device.hpp"

namespace hemiray::test {

inline Image show_patches(Context& context, const Scene& scene, const FlatScene& patches,
                          const ReferenceOptions& options, EngineKind engine = EngineKind::wavefront,
                          bool strict = false) {
  RenderOptions render = same_options(options, engine, strict);
  render.patches = &patches;
  return render_scene(context, scene, render).image;
}

}  // namespace hemiray::test
