// The vector types of the host, from GLM. Column vectors, right-handed, y up, metres.
#pragma once

#include <glm/glm.hpp>

namespace hemiray {

using Vec2 = glm::vec2;
using Vec3 = glm::vec3;
using Vec4 = glm::vec4;
using UVec3 = glm::uvec3;
using DVec3 = glm::dvec3;
using DMat4 = glm::dmat4;
using DMat3 = glm::dmat3;

}  // namespace hemiray
