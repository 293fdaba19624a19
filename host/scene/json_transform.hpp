// Transforms of the JSON scene format, and what may be asked of one.
#pragma once

#include <optional>

#include "host/scene/json_values.hpp"

namespace hemiray {

/// A transform object or an array of them, the first applied first. Within one object scale comes before rotate before
/// translate; matrix stands alone. Throws InputError for one that is singular or out of range.
DMat4 read_transform(const JsonNode& node);

/// The factor by which a similarity (rotation, reflection, translation, one scale for all axes) scales lengths; nothing
/// where the matrix is none.
std::optional<double> similarity_scale(const DMat4& matrix);

}  // namespace hemiray
