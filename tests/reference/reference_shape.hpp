// Disks, cylinders, cones and quadrics of the reference tracer, in the scene's own double numbers.
#pragma once

#include <optional>

#include "tests/reference/reference_intersect.hpp"

namespace hemiray::reference {

/// The first place beyond the ray's origin where it meets the shape. A ray that starts on a surface may meet the shape
/// again, but not where it starts.
std::optional<Hit> intersect_shape(const Shape& shape, const Ray& ray);

/// Unit normal to the front at a point of the shape.
DVec3 shape_normal(const Shape& shape, const DVec3& point);

}  // namespace hemiray::reference
