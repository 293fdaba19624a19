// Which objects of a scene share their mesh's triangles on the device, and with them one tree, instead of each having
// its own copy in the world.
#pragma once

#include <vector>

#include "host/scene/scene.hpp"

namespace hemiray {

/// never: every object is copied into the world. automatic: a mesh is shared where that saves enough. always: wherever
/// it can be, by a single object too.
enum class Instancing { never, automatic, always };

/// For each of Scene::objects whether it becomes an instance. What emits does not, since lights are sampled in the
/// world, nor does what is placed by a matrix that single precision could not turn back.
std::vector<bool> instanced_objects(const Scene& scene, Instancing instancing);

}  // namespace hemiray
