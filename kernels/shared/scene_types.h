// The scene as the kernels see it. 4-byte scalars and 16-byte aligned float4 only, padded explicitly.
#ifndef HR_SHARED_SCENE_TYPES_H
#define HR_SHARED_SCENE_TYPES_H

#include "shared/scalar.h"

HR_SHARED_BEGIN

#define HR_NO_TEXTURE 0xffffffffu

#define HR_MATERIAL_FRESNEL 1u
#define HR_MATERIAL_METALLIC_ROUGHNESS 2u
#define HR_MATERIAL_OWN_AMBIENT 4u /* ka is given; else the ambient term uses kd */

// host/scene/scene.hpp, struct Material, tells what the members mean.
typedef struct Material {
  float4 kd;        // rgb; w = shininess
  float4 ks;        // rgb; w = index of refraction inside
  float4 ka;        // rgb; w = roughness
  float4 kr;        // rgb; w = metallic
  float4 kt;        // rgb; w = normal map scale
  float4 emission;  // rgb [W/m^2/sr]
  uint kd_texture;
  uint metallic_roughness_texture;
  uint emission_texture;
  uint normal_texture;
  uint flags;
  float translucency_r, translucency_g, translucency_b;  // diffuse transmission
} Material;

#define HR_WRAP_REPEAT 0u
#define HR_WRAP_CLAMP 1u
#define HR_WRAP_MIRROR 2u
#define HR_TEXTURE_NEAREST 1u
#define HR_TEXTURE_SRGB 2u

typedef struct Texture {
  uint first_texel;  // into texels, RGBA8 with R in the low byte
  uint width;
  uint height;
  uint flags;
  uint wrap_u;
  uint wrap_v;
  uint pad0, pad1;
} Texture;

typedef struct Sphere {
  float4 center_radius;  // [m]
  uint material;
  uint object;
  uint pad0, pad1;
} Sphere;

typedef struct Plane {
  float4 point;   // [m]
  float4 normal;  // unit, to the front
  uint material;
  uint object;
  uint pad0, pad1;
} Plane;

#define HR_SHAPE_DISK 0u
#define HR_SHAPE_CONE 1u /* truncated, between two disks; a cylinder where slope = 0 */
#define HR_SHAPE_QUADRIC 2u
#define HR_SHAPE_IMPLICIT 3u

#define HR_SHAPE_CAPPED 1u
#define HR_SHAPE_CLIP_BOX 2u
#define HR_SHAPE_CLIP_SPHERE 4u

// What of a shape is hit.
#define HR_PART_SIDE 0 /* of a cone; a disk or quadric has no other */
#define HR_PART_LOWER_CAP 1
#define HR_PART_UPPER_CAP 2

// A finite surface in a frame of its own: p_own = L (p_world - place). The frame's origin is the middle of the surface,
// so that its numbers are as large as the surface and no larger.
//   disk     z = 0, x^2 + y^2 <= radius^2; front where z > 0.      form = (radius, 0, 0, 0) [own units]
//   cone     x^2 + y^2 = r(z)^2, r = mean + slope z, |z| <= half;   form = (mean radius, slope, half height, 0)
//   implicit f(p) = 0, f a tape (shared/polynomial_types.h); front where it is positive.
//                                                                form = bits of (first instruction, their number)
//   quadric  p^T A p + 2 b p + c = 0; front where it is positive.   form = (Axx, Ayy, Azz, c), mixed = (Axy, Ayz, Azx)
typedef struct Shape {
  float4 to_own_x;  // row of L; w = place [m]
  float4 to_own_y;
  float4 to_own_z;
  float4 form;
  float4 mixed;
  float4 linear;  // b; implicit: middle of the clip [own units]
  float4 clip;    // quadric: half sizes of a box or w = radius of a sphere around the origin, or `linear` [own units]
  float4 lo;      // bounds [m]; w = radius of a sphere around `place` that holds them [m]
  float4 hi;
  uint kind;
  uint flags;
  uint material;
  uint object;
} Shape;

#define HR_NO_MATERIAL 0xffffffffu
#define HR_INSTANCE_MIRRORED 1u /* L turns the winding round: second and third vertex change places */

// A mesh placed in the world that has its triangles and its tree in common with other copies: p_world = L p + T. Its
// triangles are primitives first_id, first_id + 1, ..., numbered behind all that the scene has of its own.
typedef struct Instance {
  float4 to_world_x;  // row of L, w = T [m]
  float4 to_world_y;
  float4 to_world_z;
  float4 to_object_x;  // row of the inverse of L, w = 0
  float4 to_object_y;
  float4 to_object_z;
  uint first_id;
  uint first_triangle;  // in triangles; their vertices are in object space
  uint triangle_count;
  uint mesh;      // of those shared: its tree's root is tree_roots[mesh + 1]; tree_roots[0] is that of all instances
  uint object;    // as the user numbers them
  uint material;  // of all its triangles, or HR_NO_MATERIAL: each its own
  uint flags;
  uint pad;
} Instance;

#define HR_LIGHT_POINT 0u
#define HR_LIGHT_DIRECTIONAL 1u
#define HR_LIGHT_SPOT 2u
#define HR_LIGHT_AREA 3u
#define HR_LIGHT_EMITTERS 4u

typedef struct Light {
  float4 position;   // area: corner [m]; spot: w = cosine of the outer angle
  float4 direction;  // the way the light travels; area: its unit normal; spot: w = 1 / (cos inner - cos outer)
  float4 intensity;  // rgb [W/sr, W/m^2 or W/m^2/sr]; area: w = area of one sample's cell [m^2]
  float4 edge_u;     // [m]
  float4 edge_v;     // [m]
  uint kind;
  uint samples_u;
  uint samples_v;
  uint sample_count;
  uint first_sample;     // number of samples of all lights before this one: random dimension
  uint jitter;           // 0 or 1
  uint first_primitive;  // of its own visible quad, which never shadows it
  uint primitive_count;
} Light;

// One emissive triangle or sphere that is not a rectangle.
typedef struct Emitter {
  uint primitive;
  float cumulative;   // share of the weights up to and including this one, (0, 1]
  float inverse_pdf;  // [m^2]: 1 / (chance of this emitter / its area)
  uint pad;
} Emitter;

HR_SHARED_END

#endif
