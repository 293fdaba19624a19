// The scene as plain data: what a loader produces and everything else reads. No device, no behaviour.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "host/base/vec.hpp"
#include "host/scene/expression.hpp"

namespace hemiray {

inline constexpr int kNone = -1;  ///< "no texture", "no material override"

enum class Wrap { repeat, clamp, mirror };
enum class Filter { linear, nearest };
enum class ColorSpace { srgb, linear };

/// An 8-bit RGBA image, row-major from the top left; `srgb` data are decoded to linear when sampled.
/// Texture coordinate (0,0) is the image's top left corner, v grows downwards (the glTF convention).
struct Texture {
  std::string name;
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> rgba;
  ColorSpace color_space = ColorSpace::srgb;
  Wrap wrap_u = Wrap::repeat;
  Wrap wrap_v = Wrap::repeat;
  Filter filter = Filter::linear;
};

/// Surface reflectance. In the default (Phong) workflow kd and ks are used as they stand; in the metallic-roughness
/// workflow kd holds the base colour, and kd, ks and the exponent are derived per hit from metallic and roughness:
/// kd' = base (1 - metallic), ks' = mix(0.04, base, metallic), exponent = 2 / roughness^4 - 2 (roughness is glTF's
/// perceptual roughness).
struct Material {
  std::string name;
  Vec3 kd{0.5F};            ///< diffuse reflectance (base colour if metallic_roughness) [0,1]
  std::optional<Vec3> ka;   ///< reflectance to the ambient term; kd where absent
  Vec3 ks{0.0F};            ///< specular (glossy highlight) reflectance
  float shininess = 32.0F;  ///< Blinn-Phong exponent, >= 0
  Vec3 kr{0.0F};            ///< mirror reflection weight
  Vec3 kt{0.0F};            ///< transmission weight
  float ior = 1.5F;         ///< index of refraction on the inside (back) of the surface, > 0
  bool fresnel = true;      ///< where kt > 0: kr is multiplied by R, kt by 1 - R
  Vec3 translucency{0.0F};  ///< diffuse transmission: share of what arrives on one side that leaves the other one,
                            ///< scattered; kd + translucency < 1
  Vec3 emission{0.0F};      ///< radiance leaving the front [W/m^2/sr]
  bool metallic_roughness = false;
  float metallic = 0.0F;
  float roughness = 1.0F;
  float normal_scale = 1.0F;
  int kd_texture = kNone;                  ///< multiplies kd
  int metallic_roughness_texture = kNone;  ///< G multiplies roughness, B multiplies metallic
  int emission_texture = kNone;            ///< multiplies emission
  int normal_texture = kNone;              ///< tangent-space normals
};

/// Indexed triangles in object space. normals, uvs and colors are empty or as long as positions; a zero normal means
/// "flat here". triangle_materials has one index into Scene::materials per triangle.
struct Mesh {
  std::string name;
  std::vector<Vec3> positions;  ///< [m]
  std::vector<Vec3> normals;
  std::vector<Vec2> uvs;
  std::vector<Vec3> colors;  ///< linear, multiply kd
  std::vector<UVec3> triangles;
  std::vector<std::uint32_t> triangle_materials;
  bool rectangle =
      false;  ///< two triangles (0,1,2),(0,2,3) that form a parallelogram: sampled as n x m array if emissive
};

/// A mesh placed in the world. Several objects may share one mesh.
struct Object {
  std::string name;
  std::uint32_t mesh = 0;
  DMat4 to_world{1.0};
  int material = kNone;  ///< overrides the mesh's own materials unless kNone
};

struct Sphere {
  std::string name;
  DVec3 center{0.0};    ///< world [m]
  double radius = 1.0;  ///< [m], > 0
  std::uint32_t material = 0;
};

enum class ShapeKind { disk, cylinder, cone, quadric, implicit };
enum class Clip { none, box, sphere };

/// A finite curved surface, or a disk, in a frame of its own (lengths there: own units), which `to_world` places.
///   disk            z = 0 within `radius`; its front is where z > 0
///   cylinder, cone  round the z axis from z = -half_height, where its radius is `radius`, to half_height and
///                   `upper_radius` (of a cylinder the same); closed by disks if `capped`
///   quadric         where the polynomial with these coefficients is 0, inside of `clip`; its front is where that is >
///   0
///   implicit        where `expression` is 0, inside of `clip`, which it must have; its front is where that is > 0
struct Shape {
  std::string name;
  ShapeKind kind = ShapeKind::disk;
  DMat4 to_world{1.0};
  double radius = 1.0;
  double upper_radius = 1.0;
  double half_height = 0.5;
  bool capped = true;
  std::array<double, 10> coefficients{};  ///< of x^2, y^2, z^2, xy, yz, zx, x, y, z and 1
  Expression expression;                  ///< of x, y and z in the frame
  Clip clip = Clip::none;
  DVec3 clip_center{0.0};
  DVec3 clip_half{1.0};  ///< half sizes of a box
  double clip_radius = 1.0;
  std::uint32_t material = 0;
};

/// An unbounded plane; its front is where `normal` points.
struct Plane {
  std::string name;
  DVec3 point{0.0};
  DVec3 normal{0.0, 1.0, 0.0};  ///< unit length
  std::uint32_t material = 0;
};

enum class LightKind { point, directional, spot, area };

/// A light source. Area lights are parallelograms with corner `position` and full edges `edge_u`, `edge_v`; they shine
/// to the side of cross(edge_u, edge_v) and are sampled as an array of samples_u x samples_v points.
struct Light {
  std::string name;
  LightKind kind = LightKind::point;
  DVec3 position{0.0};              ///< point, spot: place; area: corner [m]
  DVec3 direction{0.0, -1.0, 0.0};  ///< directional, spot: the way the light travels, unit length
  Vec3 intensity{1.0F};             ///< point, spot [W/sr]; directional [W/m^2]; area [W/m^2/sr]
  double inner_angle_deg = 0.0;     ///< spot: half angle of full intensity
  double outer_angle_deg = 45.0;    ///< spot: half angle at which it is zero
  DVec3 edge_u{1.0, 0.0, 0.0};
  DVec3 edge_v{0.0, 0.0, 1.0};
  int samples_u = 4;
  int samples_v = 4;
  bool jitter = true;
  bool visible = true;  ///< area: is also a one-sided emissive quad in the scene
};

enum class CameraKind { perspective, orthographic };

/// The camera looks along -z of its own frame, y up.
struct Camera {
  CameraKind kind = CameraKind::perspective;
  DMat4 to_world{1.0};      ///< rigid
  double fov_y_deg = 45.0;  ///< perspective: full vertical field of view, in (0, 180)
  double height_m = 2.0;    ///< orthographic: full height of the image in the world
  int width = 512;          ///< default image size [pixels]
  int height = 512;
};

enum class Shading { physical, phong };

/// Everything that is rendered. Filled by the loaders, completed by finish_scene().
struct Scene {
  std::filesystem::path source;
  std::string title;
  Camera camera;
  Vec3 background{0.0F};  ///< radiance of a miss [W/m^2/sr]
  Vec3 ambient{0.0F};     ///< La [W/m^2/sr]
  Shading shading = Shading::physical;
  int depth = 8;             ///< default number of specular bounces
  int emitter_samples = 16;  ///< shadow rays per shading point to all emissive meshes that are not rectangles
  std::vector<Material> materials;
  std::vector<Texture> textures;
  std::vector<Mesh> meshes;
  std::vector<Object> objects;
  std::vector<Sphere> spheres;
  std::vector<Shape> shapes;
  std::vector<Plane> planes;
  std::vector<Light> lights;
  bool has_camera = false;              ///< false: finish_scene() frames the bounds
  bool has_lights = false;              ///< false: finish_scene() adds a light if nothing emits
  std::uint64_t dropped_triangles = 0;  ///< non-finite or degenerate, dropped by a loader
  std::vector<std::string> notes;       ///< defaults taken and unsupported features, one line each, shown to the user
};

}  // namespace hemiray
