// The surface at a hit: position with its error bound, normals, and reflectances after textures.
#ifndef HR_LIB_SURFACE_H
#define HR_LIB_SURFACE_H

#include "lib/edge_distance.h"
#include "lib/instance.h"
#include "lib/intersect.h"
#include "lib/mesh_vertices.h"
#include "lib/scene_view.h"
#include "lib/shape_surface.h"
#include "lib/sphere_surface.h"
#include "lib/terminator.h"
#include "lib/texture.h"
#include "lib/vec.h"

#if HR_HAS(IMPLICITS)
#include "lib/implicit.h"
#endif

// A perfectly smooth highlight (roughness 0) would have an infinite exponent.
#define HR_MIN_ROUGHNESS REAL(0.01)
#define HR_MAX_SHININESS REAL(1e6)
// Reflectance of a dielectric at normal incidence in glTF's metallic-roughness model.
#define HR_DIELECTRIC_F0 REAL(0.04)

typedef struct Surface {
  real3 position;
  real3 error;           // bound of |position - exact point| per axis [m]
  real3 normal;          // geometric, unit, to the side the ray came from
  real3 shading_normal;  // unit, on the same side
  real3 lift;            // from position to where shadow rays start [m] (lib/terminator.h)
  real3 kd, ks, ka, emission;
  real shininess;
  uint material;
  uint object;
  uint front;  // 1 if the ray came to the front
} Surface;

// Normal map: the tangent follows the triangle's u, made orthogonal to n; the bitangent follows -v (glTF's +Y is up in
// the image, our v runs down).
static inline real3 perturb_normal(const SceneView* view, const TriangleGeometry* g, real2 uv, uint texture, real scale,
                                   real3 n) {
  const real2 uva = load_uv(view, g->indices.x);
  const real2 d1 = load_uv(view, g->indices.y) - uva, d2 = load_uv(view, g->indices.z) - uva;
  const real det = d1.x * d2.y - d1.y * d2.x;
  if (det == 0) return n;
  const real3 e1 = g->b - g->a, e2 = g->c - g->a;
  const real sign = det < 0 ? -REAL(1.0) : REAL(1.0);
  const real3 along_u = (e1 * d2.y - e2 * d1.y) * sign;
  const real3 along_v = (e2 * d1.x - e1 * d2.x) * sign;
  const real3 t = along_u - n * dot3(n, along_u);
  const real t2 = dot3(t, t);
  if (!(t2 > 0)) return n;
  const real3 tangent = divide3(t, square_root(t2));
  const real3 side = cross3(n, tangent);
  const real3 bitangent = dot3(side, along_v) > 0 ? -side : side;
  const real3 m = sample_texture(view, texture, uv) * 2 - 1;
  const real3 p = tangent * (m.x * scale) + bitangent * (m.y * scale) + n * m.z;
  return dot3(p, p) > 0 ? normalize3(p) : n;
}

// Reflectances of `material` at texture coordinates uv, times the vertex colour.
static inline void shade_material(const SceneView* view, uint index, real2 uv, bool has_uv, real3 color, Surface* s) {
  const Material m = view->materials[index];
  real3 base = (real3)(m.kd.x, m.kd.y, m.kd.z) * color;
  s->emission = HR_HAS(EMISSION) ? (real3)(m.emission.x, m.emission.y, m.emission.z) : (real3)(0);
  if (HR_HAS(TEXTURES) && has_uv) {
    if (m.kd_texture != HR_NO_TEXTURE) base *= sample_texture(view, m.kd_texture, uv);
    if (HR_HAS(EMISSION) && m.emission_texture != HR_NO_TEXTURE) {
      s->emission *= sample_texture(view, m.emission_texture, uv);
    }
  }
  s->kd = base;
  s->ks = (real3)(m.ks.x, m.ks.y, m.ks.z);
  s->shininess = m.kd.w;
  if (HR_HAS(METALLIC_ROUGHNESS) && (m.flags & HR_MATERIAL_METALLIC_ROUGHNESS)) {
    real roughness = m.ka.w, metallic = m.kr.w;
    if (HR_HAS(TEXTURES) && has_uv && m.metallic_roughness_texture != HR_NO_TEXTURE) {
      const real3 texel = sample_texture(view, m.metallic_roughness_texture, uv);
      roughness *= texel.y;
      metallic *= texel.z;
    }
    const real r = clamp(roughness, HR_MIN_ROUGHNESS, REAL(1.0));
    s->kd = base * (1 - metallic);
    s->ks = (real3)(HR_DIELECTRIC_F0) * (1 - metallic) + base * metallic;
    s->shininess = clamp(divide(2, r * r * r * r) - 2, REAL(0.0), HR_MAX_SHININESS);
  }
  s->ka = (m.flags & HR_MATERIAL_OWN_AMBIENT) ? (real3)(m.ka.x, m.ka.y, m.ka.z) : s->kd;
}

// Everything about the hit of a ray; error bounds follow pbrt (4th ed., 6.8.4-5): position from barycentrics, on the
// sphere and on shapes by reprojection, on the plane by projection.
static inline Surface surface_at(const SceneView* view, real3 origin, real3 direction, const Hit* hit) {
  Surface s;
  real3 color = (real3)(1);
  real2 uv = (real2)(0);
  bool has_uv = false;
  real3 outward = (real3)(0, 0, 1);
  real3 interpolated = outward;
  uint material = 0;
  TriangleGeometry g;
  VertexNormals normals = {(real3)(0), (real3)(0), (real3)(0), false};
  global const Instance* instance = 0;
  if (HR_HAS(INSTANCES) && hit->primitive >= first_instanced(view)) instance = instance_of(view, hit->primitive);
  if (HR_HAS(TRIANGLES) && (instance || hit->primitive < view->triangle_count)) {
    g = instance ? load_instanced(view, instance, hit->primitive) : load_triangle(view, hit->primitive);
    material = g.indices.w;
    s.object = instance ? instance->object : view->triangle_objects[hit->primitive];
    const real3 wa = g.a * (1 - hit->u - hit->v), wb = g.b * hit->u, wc = g.c * hit->v;
    s.position = wa + wb + wc;
    s.error = (fabs(wa) + fabs(wb) + fabs(wc)) * HR_GAMMA(7);
    if (HR_HAS(INSTANCES) && instance) {
      point_to_world(instance, &s.position, &s.error);
      g.b = vector_to_world(instance, g.b - g.a);
      g.c = vector_to_world(instance, g.c - g.a);
      g.a = (real3)(0);  // from here on only edges count
    }
    s.position += way_off_edges(hit->u, hit->v, g.b - g.a, g.c - g.a, s.error);
    outward = normal_of_edges(g.b - g.a, g.c - g.a);
    interpolated = outward;
    if (HR_HAS(SMOOTH_NORMALS)) {
      normals = load_vertex_normals(view, g.indices, instance);
      if (normals.smooth) interpolated = interpolate_normal(&normals, hit->u, hit->v, outward);
    }
    if (HR_HAS(TEXTURES)) {
      uv = interpolate_uv(view, g.indices, hit->u, hit->v);
      has_uv = true;
    }
    if (HR_HAS(VERTEX_COLORS)) {
      color = load_color(view, g.indices.x) * (1 - hit->u - hit->v) + load_color(view, g.indices.y) * hit->u +
              load_color(view, g.indices.z) * hit->v;
    }
  } else if (HR_HAS(SPHERES) && hit->primitive < first_shape(view)) {
    const Sphere sphere = view->spheres[hit->primitive - view->triangle_count];
    const real3 center = (real3)(sphere.center_radius.x, sphere.center_radius.y, sphere.center_radius.z);
    outward = sphere_outward(origin, direction, center, sphere.center_radius.w, hit->t);
    interpolated = outward;
    s.position = center + outward * sphere.center_radius.w;
    s.error = (fabs(center) + sphere.center_radius.w) * HR_GAMMA(7);
    material = sphere.material;
    s.object = sphere.object;
  } else if (HR_HAS(SHAPES) && hit->primitive < first_plane(view)) {
    global const Shape* shape = view->shapes + (hit->primitive - first_shape(view));
#if HR_HAS(IMPLICITS)
    if (shape->kind == HR_SHAPE_IMPLICIT) {
      implicit_surface(view->tapes, shape, origin, direction, hit->t, &s.position, &s.error, &outward);
    } else
#endif
    {
      shape_surface(shape, origin, direction, hit, &s.position, &s.error, &outward);
    }
    interpolated = outward;
    material = shape->material;
    s.object = shape->object;
  } else if (HR_HAS(PLANES)) {
    const Plane plane = view->planes[hit->primitive - first_plane(view)];
    const real3 point = (real3)(plane.point.x, plane.point.y, plane.point.z);
    outward = (real3)(plane.normal.x, plane.normal.y, plane.normal.z);
    interpolated = outward;
    const real3 p = origin + direction * hit->t;
    s.position = p - outward * dot3(p - point, outward);
    s.error = (fabs(p) + fabs(point)) * HR_GAMMA(9);
    material = plane.material;
    s.object = plane.object;
  }
  s.material = material;
  s.front = dot3(outward, direction) < 0 ? 1u : 0u;
  s.normal = s.front ? outward : -outward;
  s.lift = (real3)(0);
#if !HR_HARD_TERMINATOR
  if (HR_HAS(SMOOTH_NORMALS) && normals.smooth) {
    s.lift = shadow_lift(g.b - g.a, g.c - g.a, hit->u, hit->v, normals.a, normals.b, normals.c, s.normal);
  }
#endif
  if (HR_HAS(NORMAL_MAPS) && has_uv) {
    const Material m = view->materials[material];
    if (m.normal_texture != HR_NO_TEXTURE) {
      interpolated = perturb_normal(view, &g, uv, m.normal_texture, m.kt.w, interpolated);
    }
  }
  s.shading_normal = dot3(interpolated, s.normal) < 0 ? -interpolated : interpolated;
  shade_material(view, material, uv, has_uv, color, &s);
  return s;
}

#endif
