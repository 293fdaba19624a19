// The camera's frame from where it stands and what it looks at.
#pragma once

#include "host/base/vec.hpp"

namespace hemiray {

/// Rigid matrix that takes camera space (looking along -z, y up) to the world. `position` and `target` must differ and
/// `up` (any length) must not be parallel to the line between them.
inline DMat4 look_at_matrix(const DVec3& position, const DVec3& target, const DVec3& up) {
  const DVec3 z = glm::normalize(position - target);
  const DVec3 x = glm::normalize(glm::cross(up, z));
  const DVec3 y = glm::cross(z, x);
  return {glm::dvec4(x, 0.0), glm::dvec4(y, 0.0), glm::dvec4(z, 0.0), glm::dvec4(position, 1.0)};
}

}  // namespace hemiray
