// The renderer as the image tests call it: with the same options as the reference tracer.
#pragma once

#include "host/path/engine.hpp"
#include "tests/reference/whitted_reference.hpp"

namespace hemiray {

/// Renders on the default device. Layers as render_reference() gives them. Throws what render_scene() throws.
Image render_on_device(const Scene& scene, const ReferenceOptions& options, EngineKind engine = EngineKind::wavefront,
                       bool strict = false);

}  // namespace hemiray
