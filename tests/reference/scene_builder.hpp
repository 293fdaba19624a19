// Small scenes in code, for the tests of the reference tracer and against it.
#pragma once

#include "host/base/image.hpp"
#include "host/scene/scene.hpp"

namespace hemiray::reference {

/// Camera-to-world transform that looks from `eye` to `target`, `up` upwards.
DMat4 look_at(const DVec3& eye, const DVec3& target, const DVec3& up = {0.0, 1.0, 0.0});

/// A scene with a perspective camera and nothing else; background and ambient are black.
Scene empty_scene(const DVec3& eye, const DVec3& target, double fov_y_deg = 45.0);

/// Appends and returns the index.
std::uint32_t add_material(Scene& scene, const Material& material);

/// Materials that do one thing.
Material diffuse(const Vec3& kd);
Material mirror(float kr);
Material glass(float ior);
Material emissive(const Vec3& emission);

/// A parallelogram object (mesh with `rectangle` set) with uvs (0,0), (1,0), (1,1), (0,1) at corner, corner + u,
/// corner + u + v, corner + v; front where cross(u, v) points. Returns the object's index.
std::size_t add_rectangle(Scene& scene, const DVec3& corner, const DVec3& u, const DVec3& v, std::uint32_t material);

/// A closed box mesh from `low` to `high`, outward front. Returns the object's index.
std::size_t add_box(Scene& scene, const DVec3& low, const DVec3& high, std::uint32_t material);

/// A sphere of triangles with smooth vertex normals and uvs: `rings` x 2 `rings` cells. Returns the object's index.
std::size_t add_smooth_ball(Scene& scene, const DVec3& center, double radius, int rings, std::uint32_t material);

void add_sphere(Scene& scene, const DVec3& center, double radius, std::uint32_t material);
void add_plane(Scene& scene, const DVec3& point, const DVec3& normal, std::uint32_t material);
Light& add_point_light(Scene& scene, const DVec3& position, const Vec3& intensity);
Light& add_area_light(Scene& scene, const DVec3& corner, const DVec3& u, const DVec3& v, const Vec3& radiance);

/// A texture of `size` x `size` texels from `texel(x, y)` = {r, g, b} bytes.
template <class Texel>
int add_texture(Scene& scene, int size, ColorSpace space, const Texel& texel) {
  Texture texture;
  texture.width = texture.height = size;
  texture.color_space = space;
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      const glm::u8vec3 rgb = texel(x, y);
      texture.rgba.insert(texture.rgba.end(), {rgb.r, rgb.g, rgb.b, 255});
    }
  }
  scene.textures.push_back(std::move(texture));
  return static_cast<int>(scene.textures.size()) - 1;
}

/// Channel `c` of pixel (x, y) of a layer; throws std::out_of_range where the layer or pixel does not exist.
double value_at(const Image& image, const std::string& layer, int x, int y, std::size_t c = 0);

}  // namespace hemiray::reference
