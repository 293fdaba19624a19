// From where a benchmark's primary rays start, and where its light is.
#pragma once

#include "host/base/vec.hpp"
#include "host/scene/flat_scene.hpp"
#include "host/scene/scene.hpp"

namespace hemiray::bench {

/// A pinhole camera with a square picture, and a point light, in the world [m].
struct View {
  Vec3 eye{0.0F};
  Vec3 forward{0.0F, 0.0F, -1.0F};  ///< unit length
  float half_extent = 0.8F;         ///< of the picture at distance 1
  Vec3 light{0.0F};
};

/// Sees all of a scene from outside, a little from above; the light stands above it. The scene has a triangle.
View framing_view(const FlatScene& flat);

/// Where the scene's own camera stands; the vertical field of view is the picture's. The light is its first point,
/// spot or area light, else the one of framing_view(). Orthographic cameras are framed anew.
View camera_view(const Scene& scene, const FlatScene& flat);

}  // namespace hemiray::bench
