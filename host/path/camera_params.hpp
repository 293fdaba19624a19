// The camera, as the kernels take it.
#pragma once

#include "host/scene/scene.hpp"
#include "shared/params.h"

namespace hemiray {

/// Fills the camera_* members and width and height for an image of that size [pixels].
void set_camera(shared::RenderParams& params, const Camera& camera, int width, int height);

}  // namespace hemiray
