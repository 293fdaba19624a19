// Texture look-up of the reference tracer, in double.
#pragma once

#include "host/scene/scene.hpp"

namespace hemiray::reference {

/// Linear RGB in [0,1] at texture coordinate `uv` ((0,0) is the top left corner, v downwards): bilinear or nearest,
/// wrapped; sRGB texels are decoded before they are mixed.
DVec3 sample_texture(const Texture& texture, const glm::dvec2& uv);

}  // namespace hemiray::reference
