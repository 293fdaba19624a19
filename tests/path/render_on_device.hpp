// The renderer as the image tests call it: with the same options as the reference tracer.
#pragma once

#include "host/gpu/device_profile.hpp"
#include "host/path/render.hpp"
#include "tests/reference/whitted_reference.hpp"

namespace hemiray {

/// The default device's profile with a tail of the wavefront of its own. With 0 every path runs through the kernels of
/// the stages to its end; small pictures would otherwise be all tail.
DeviceProfile profile_with_tail(std::uint32_t tail_paths);

/// The renderer's options that mean the same.
RenderOptions same_options(const ReferenceOptions& options, EngineKind engine, bool strict);

/// Renders on the default device. Layers as render_reference() gives them. Throws what render_scene() throws.
Image render_on_device(const Scene& scene, const ReferenceOptions& options, EngineKind engine = EngineKind::wavefront,
                       bool strict = false, std::uint32_t tail_paths = 0);

}  // namespace hemiray
