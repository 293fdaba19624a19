// The camera of the reference tracers.
#pragma once

#include "tests/reference/reference_intersect.hpp"
#include "tests/reference/whitted_reference.hpp"

namespace hemiray::reference {

/// The ray through `offset` in [0,1)^2, from the top left, of pixel (x, y) of an image of the options' size.
Ray camera_ray(const Camera& camera, const ReferenceOptions& options, int x, int y, const glm::dvec2& offset);

}  // namespace hemiray::reference
