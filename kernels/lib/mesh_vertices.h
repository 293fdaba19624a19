// What the vertices of a mesh's triangle hold, and what it is between them.
#ifndef HR_LIB_MESH_VERTICES_H
#define HR_LIB_MESH_VERTICES_H

#include "lib/instance.h"
#include "lib/scene_view.h"
#include "lib/vec.h"

typedef struct TriangleGeometry {
  uint4 indices;  // w = material
  real3 a, b, c;
} TriangleGeometry;

static inline real3 load_position(const SceneView* view, uint i) {
  return (real3)(view->positions[3 * i], view->positions[3 * i + 1], view->positions[3 * i + 2]);
}

static inline real3 load_normal(const SceneView* view, uint i) {
  return (real3)(view->normals[3 * i], view->normals[3 * i + 1], view->normals[3 * i + 2]);
}

static inline real3 load_color(const SceneView* view, uint i) {
  return (real3)(view->colors[3 * i], view->colors[3 * i + 1], view->colors[3 * i + 2]);
}

static inline real2 load_uv(const SceneView* view, uint i) { return (real2)(view->uvs[i].x, view->uvs[i].y); }

static inline real2 interpolate_uv(const SceneView* view, uint4 i, real u, real v) {
  return load_uv(view, i.x) * (1 - u - v) + load_uv(view, i.y) * u + load_uv(view, i.z) * v;
}

static inline TriangleGeometry load_triangle(const SceneView* view, uint triangle) {
  TriangleGeometry g;
  g.indices = view->triangles[triangle];
  g.a = load_position(view, g.indices.x);
  g.b = load_position(view, g.indices.y);
  g.c = load_position(view, g.indices.z);
  return g;
}

// Triangle `primitive` of an instance as it would stand in the world's own triangles, but in object space.
static inline TriangleGeometry load_instanced(const SceneView* view, global const Instance* instance, uint primitive) {
  TriangleGeometry g = load_triangle(view, instance->first_triangle + (primitive - instance->first_id));
  if (instance->flags & HR_INSTANCE_MIRRORED) {
    g.indices.yz = g.indices.zy;
    const real3 b = g.b;
    g.b = g.c;
    g.c = b;
  }
  if (instance->material != HR_NO_MATERIAL) g.indices.w = instance->material;
  return g;
}

typedef struct VertexNormals {
  real3 a, b, c;  // in the world
  bool smooth;    // no vertex lacks one
} VertexNormals;

// `instance` may be null.
static inline VertexNormals load_vertex_normals(const SceneView* view, uint4 i, global const Instance* instance) {
  VertexNormals n = {load_normal(view, i.x), load_normal(view, i.y), load_normal(view, i.z), true};
  n.smooth = dot3(n.a, n.a) != 0 && dot3(n.b, n.b) != 0 && dot3(n.c, n.c) != 0;
  if (HR_HAS(INSTANCES) && instance) {
    n.a = normal_to_world(instance, n.a);
    n.b = normal_to_world(instance, n.b);
    n.c = normal_to_world(instance, n.c);
  }
  return n;
}

static inline real3 interpolate_normal(const VertexNormals* normals, real u, real v, real3 fallback) {
  const real3 n = normals->a * (1 - u - v) + normals->b * u + normals->c * v;
  return dot3(n, n) > 0 ? normalize3(n) : fallback;
}

#endif
