// The scene of the reference tracer: every primitive in world space, in double.
#pragma once

#include <array>
#include <vector>

#include "host/scene/scene.hpp"

namespace hemiray::reference {

/// Primitive kinds in the order that decides between hits at the same distance.
enum class Kind { none, triangle, quad, sphere, shape, plane };

/// Names one primitive: an index into the World's list of that kind.
struct PrimitiveId {
  Kind kind = Kind::none;
  std::size_t index = 0;
  bool operator==(const PrimitiveId&) const = default;
};

/// A triangle whose corners [m] were rounded to float after the transform, as the renderer does.
struct WorldTriangle {
  std::array<DVec3, 3> corners;
  std::array<DVec3, 3> normals;  ///< unit length where `smooth`
  std::array<glm::dvec2, 3> uvs;
  std::array<DVec3, 3> colors;  ///< 1 where the mesh has none
  bool smooth = false;          ///< all three vertex normals are non-zero
  bool has_uvs = false;
  std::size_t material = 0;
  std::size_t object = 0;
  DVec3 normal;  ///< geometric, unit length, counter-clockwise front
  double area_m2 = 0.0;
};

/// A visible area light: a parallelogram, front where `normal` points.
struct WorldQuad {
  DVec3 corner, edge_u, edge_v, normal;
  DVec3 emission;
  std::size_t light = 0;  ///< index into Scene::lights
};

/// What the tracer sees; keeps a reference to the scene, which must outlive it.
struct World {
  explicit World(const Scene& scene_in);

  const Scene& scene;
  std::vector<WorldTriangle> triangles;
  std::vector<WorldQuad> quads;

  /// The object id layer's value: 1 + index in [objects, spheres, shapes, planes, visible area lights].
  [[nodiscard]] std::size_t object_id(const PrimitiveId& primitive) const;
};

/// The index of the material of triangle `triangle` of `object`: its override, or the mesh's own.
std::size_t material_of(const Scene& scene, const Object& object, std::size_t triangle);

/// A vertex of the object in world space: transformed in double, rounded to float once.
DVec3 world_position(const Object& object, const Vec3& position);

}  // namespace hemiray::reference
