// Implicit surfaces of the reference tracer: by bisection of intervals in long double, on the expression itself.
#pragma once

#include <optional>

#include "tests/reference/reference_intersect.hpp"

namespace hemiray::reference {

/// The first place beyond the ray's origin, within the clip, where the expression changes its sign. A ray that starts
/// on the surface may meet it again, but not where it starts; touching does not count.
std::optional<Hit> intersect_implicit(const Shape& shape, const Ray& ray);

/// Unit normal to the front at a point of the surface.
DVec3 implicit_normal(const Shape& shape, const DVec3& point);

}  // namespace hemiray::reference
