// Shapes as the device wants them, and where they lie: computed in double, rounded once, bounds outwards.
#pragma once

#include <string>

#include "host/scene/bounds.hpp"
#include "host/scene/scene.hpp"
#include "shared/scene_types.h"

namespace hemiray {

/// What keeps a shape from being traced, as "must be ..."; empty if nothing does.
std::string shape_fault(const Shape& shape);

/// Bounds in the world [m]: exact for disks, cylinders, cones and ellipsoids; of quadrics and implicit surfaces in a
/// clip as zero_bounds() finds them, mostly too large by less than a hundredth of it. The shape must be without fault.
WorldBounds shape_bounds(const Shape& shape);

/// The device's shape, but for its object and the place of its tape. The shape must be without fault.
shared::Shape flatten_shape(const Shape& shape);

}  // namespace hemiray
