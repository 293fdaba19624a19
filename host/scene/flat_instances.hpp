// Meshes that objects share, appended to a flat scene, and the instances that place them.
#pragma once

#include <vector>

#include "host/scene/flat_scene.hpp"

namespace hemiray {

/// Which vertex attributes a flat scene has.
struct Attributes {
  bool normals = false, uvs = false, colors = false;
};

/// Appends a vertex; attributes the mesh lacks get their neutral value.
void append_vertex(FlatScene& flat, const Attributes& needed, Vec3 position, Vec3 normal, Vec2 uv, Vec3 color);

/// Throws DeviceError if a flat scene cannot hold so many vertices and triangles more.
void check_room(const FlatScene& flat, const Mesh& mesh);

/// Appends the meshes of all instanced objects, in object space, and fills `instances`. To be called when everything
/// else is there: the instances' triangles are numbered behind all other primitives. Throws DeviceError if primitive
/// indices, or those of instances, do not suffice.
void append_instances(const Scene& scene, const std::vector<bool>& instanced, const Attributes& needed,
                      FlatScene& flat);

}  // namespace hemiray
