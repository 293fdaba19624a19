// The last line of defence before the device: everything kernels take for granted about a scene.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "host/base/error.hpp"
#include "host/scene/bounds.hpp"
#include "host/scene/json_values.hpp"
#include "host/scene/load.hpp"
#include "host/scene/shape_geometry.hpp"

namespace hemiray {
namespace {

constexpr double kUnitTolerance = 1e-6;  // of a unit vector's squared length and of rigid matrices
constexpr int kMaxImageSide = 1 << 16;

class Validator {
 public:
  explicit Validator(const Scene& scene)
      : scene_(scene), file_(scene.source.empty() ? std::string("scene") : scene.source.string()) {}

  void run() {
    settings();
    for (std::size_t i = 0; i < scene_.textures.size(); ++i) texture(scene_.textures[i], place("textures", i));
    for (std::size_t i = 0; i < scene_.materials.size(); ++i) material(scene_.materials[i], place("materials", i));
    for (std::size_t i = 0; i < scene_.meshes.size(); ++i) mesh(scene_.meshes[i], place("meshes", i));
    for (std::size_t i = 0; i < scene_.objects.size(); ++i) object(scene_.objects[i], place("objects", i));
    for (std::size_t i = 0; i < scene_.spheres.size(); ++i) sphere(scene_.spheres[i], place("spheres", i));
    for (std::size_t i = 0; i < scene_.shapes.size(); ++i) shape(scene_.shapes[i], place("shapes", i));
    for (std::size_t i = 0; i < scene_.planes.size(); ++i) plane(scene_.planes[i], place("planes", i));
    for (std::size_t i = 0; i < scene_.lights.size(); ++i) light(scene_.lights[i], place("lights", i));
  }

 private:
  static std::string place(std::string_view list, std::size_t index) { return fmt::format("/{}/{}", list, index); }

  void require(bool good, const std::string& where, const char* what) const {
    if (!good) fail(where, what);
  }
  [[noreturn]] void fail(const std::string& where, const std::string& what) const {
    throw InputError(file_ + ": " + where, what);
  }

  template <typename Vector>
  static bool within(const Vector& v, double low, double high) {
    for (int c = 0; c < Vector::length(); ++c) {
      if (!(static_cast<double>(v[c]) >= low && static_cast<double>(v[c]) <= high)) return false;  // false for NaN too
    }
    return true;
  }
  static bool coordinates(const DVec3& v) { return within(v, -kMaxCoordinate, kMaxCoordinate); }
  static bool radiance(const Vec3& v) {
    return within(v, 0.0, static_cast<float>(kMaxRadiance));  // the limit itself, rounded like the values
  }
  static bool unit(const DVec3& v) { return std::abs(glm::dot(v, v) - 1.0) <= kUnitTolerance; }
  static bool between(double v, double low, double high) { return v >= low && v <= high; }

  void settings() const {
    const Camera& camera = scene_.camera;
    require(between(camera.width, 1, kMaxImageSide) && between(camera.height, 1, kMaxImageSide), "/camera/size",
            "width and height must be from 1 to 65536 pixels");
    require(camera.fov_y_deg > 0.0 && camera.fov_y_deg < 180.0, "/camera/fov", "must be between 0 and 180 degrees");
    require(camera.height_m > 0.0 && camera.height_m <= kMaxCoordinate, "/camera/orthographic_height",
            "must be positive and finite");
    const DVec3 x(camera.to_world[0]);
    const DVec3 y(camera.to_world[1]);
    const DVec3 z(camera.to_world[2]);
    require(unit(x) && unit(y) && unit(z) && coordinates(DVec3(camera.to_world[3])) &&
                glm::length(glm::cross(x, y) - z) <= kUnitTolerance,
            "/camera", "its matrix must be rigid and finite");
    require(radiance(scene_.background), "/background", "must be finite and not negative");
    require(radiance(scene_.ambient), "/ambient", "must be finite and not negative");
    require(scene_.depth >= 0, "/depth", "must not be negative");
    require(scene_.emitter_samples >= 1, "/emitter_samples", "must be at least 1");
  }

  void texture(const Texture& t, const std::string& where) const {
    require(t.width > 0 && t.height > 0, where, "width and height must be positive");
    require(t.rgba.size() == 4 * static_cast<std::size_t>(t.width) * static_cast<std::size_t>(t.height), where,
            "its data are not width x height x 4 bytes long");
  }

  void material(const Material& m, const std::string& where) const {
    for (const Vec3& weight : {m.kd, m.ka.value_or(Vec3(0.0F)), m.ks, m.kr, m.kt, m.translucency}) {
      require(radiance(weight), where, "a reflectance is negative or not finite");
    }
    require(m.translucency == Vec3(0.0F) || glm::all(glm::lessThan(m.kd + m.translucency, Vec3(1.0F))),
            where + "/translucency", "must be below 1 together with kd");
    require(radiance(m.emission), where + "/emission", "must be finite and not negative");
    require(between(m.shininess, 0.0, kMaxRadiance), where + "/shininess", "must be finite and not negative");
    require(m.ior > 0.0F && std::isfinite(m.ior), where + "/ior", "must be positive and finite");
    require(between(m.metallic, 0.0, 1.0), where + "/metallic", "must be from 0 to 1");
    require(between(m.roughness, 0.0, 1.0), where + "/roughness", "must be from 0 to 1");
    require(std::isfinite(m.normal_scale), where + "/normal_scale", "must be finite");
    for (const int index : {m.kd_texture, m.metallic_roughness_texture, m.emission_texture, m.normal_texture}) {
      if (index != kNone && (index < 0 || static_cast<std::size_t>(index) >= scene_.textures.size())) {
        fail(where, fmt::format("texture {} is out of range: there are {}", index, scene_.textures.size()));
      }
    }
  }

  void mesh(const Mesh& m, const std::string& where) const {
    const std::size_t count = m.positions.size();
    for (std::size_t i = 0; i < count; ++i) {
      if (!within(m.positions[i], -kMaxCoordinate, kMaxCoordinate)) {
        fail(fmt::format("{}/positions/{}", where, i), "not finite, or beyond 1e18 m");
      }
    }
    const auto lengths = [&](std::size_t size, const char* list) {
      if (size != 0 && size != count) fail(where + list, fmt::format("{} elements for {} vertices", size, count));
    };
    lengths(m.normals.size(), "/normals");
    lengths(m.uvs.size(), "/uvs");
    lengths(m.colors.size(), "/colors");
    const auto in_range = [](const auto& list, double limit) {
      return std::all_of(list.begin(), list.end(), [=](const auto& v) { return within(v, -limit, limit); });
    };
    require(in_range(m.normals, kMaxCoordinate), where + "/normals", "a normal is not finite");
    require(in_range(m.uvs, kMaxCoordinate), where + "/uvs", "a texture coordinate is not finite");
    require(in_range(m.colors, kMaxCoordinate), where + "/colors", "a colour is not finite");
    for (std::size_t i = 0; i < m.triangles.size(); ++i) {
      const UVec3& t = m.triangles[i];
      const std::uint32_t largest = std::max({t.x, t.y, t.z});
      if (largest >= count) {
        fail(fmt::format("{}/triangles/{}", where, i),
             fmt::format("vertex {} is out of range: there are {}", largest, count));
      }
    }
    if (m.triangle_materials.size() != m.triangles.size()) {
      fail(where + "/triangle_materials",
           fmt::format("{} elements for {} triangles", m.triangle_materials.size(), m.triangles.size()));
    }
    for (std::size_t i = 0; i < m.triangle_materials.size(); ++i) {
      material_index(m.triangle_materials[i], fmt::format("{}/triangle_materials/{}", where, i));
    }
    require(!m.rectangle || (count == 4 && m.triangles.size() == 2), where, "a rectangle has 4 vertices, 2 triangles");
  }

  void material_index(std::int64_t index, const std::string& where) const {
    if (index < 0 || static_cast<std::size_t>(index) >= scene_.materials.size()) {
      fail(where, fmt::format("material {} is out of range: there are {}", index, scene_.materials.size()));
    }
  }

  void object(const Object& o, const std::string& where) const {
    if (o.mesh >= scene_.meshes.size()) {
      fail(where + "/mesh", fmt::format("mesh {} is out of range: there are {}", o.mesh, scene_.meshes.size()));
    }
    if (o.material != kNone) material_index(o.material, where + "/material");
    const glm::dvec4 last_row(o.to_world[0][3], o.to_world[1][3], o.to_world[2][3], o.to_world[3][3]);
    require(last_row == glm::dvec4(0.0, 0.0, 0.0, 1.0), where + "/to_world", "the last row must be 0 0 0 1");
    for (int column = 0; column < 4; ++column) {
      require(coordinates(DVec3(o.to_world[column])), where + "/to_world", "not finite, or beyond 1e18");
    }
    for (const Vec3& position : scene_.meshes[o.mesh].positions) {
      require(coordinates(DVec3(o.to_world * glm::dvec4(position, 1.0))), where,
              "a vertex lies beyond 1e18 m in the world");
    }
  }

  void sphere(const Sphere& s, const std::string& where) const {
    require(coordinates(s.center), where + "/center", "not finite, or beyond 1e18 m");
    require(s.radius > 0.0 && s.radius <= kMaxCoordinate, where + "/radius", "must be positive and at most 1e18 m");
    material_index(s.material, where + "/material");
  }

  void shape(const Shape& s, const std::string& where) const {
    const std::string fault = shape_fault(s);
    if (!fault.empty()) fail(where, fault);
    material_index(s.material, where + "/material");
    require(scene_.materials[s.material].emission == Vec3(0.0F), where + "/material",
            "of the curved surfaces only spheres can emit");
  }

  void plane(const Plane& p, const std::string& where) const {
    require(coordinates(p.point), where + "/point", "not finite, or beyond 1e18 m");
    require(unit(p.normal), where + "/normal", "must be of unit length");
    material_index(p.material, where + "/material");
    require(scene_.materials[p.material].emission == Vec3(0.0F), where + "/material",
            "a plane is unbounded and cannot emit");
  }

  void light(const Light& l, const std::string& where) const {
    require(coordinates(l.position), where + "/position", "not finite, or beyond 1e18 m");
    require(radiance(l.intensity), where, "its colour must be finite and not negative");
    if (l.kind == LightKind::directional || l.kind == LightKind::spot) {
      require(unit(l.direction), where + "/direction", "must be of unit length");
    }
    if (l.kind == LightKind::spot) {
      require(l.outer_angle_deg > 0.0 && l.outer_angle_deg <= 90.0, where + "/outer_angle",
              "must be above 0 and at most 90 degrees");
      require(between(l.inner_angle_deg, 0.0, l.outer_angle_deg), where + "/inner_angle",
              "must be from 0 to the outer angle");
    }
    if (l.kind != LightKind::area) return;
    require(coordinates(l.edge_u) && coordinates(l.edge_v), where, "an edge is not finite, or beyond 1e18 m");
    require(glm::length(glm::cross(l.edge_u, l.edge_v)) > 0.0, where, "its edges span no area");
    require(l.samples_u >= 1 && l.samples_v >= 1, where + "/samples", "must be at least 1 along each edge");
  }

  const Scene& scene_;
  std::string file_;
};

}  // namespace

void validate_scene(const Scene& scene) { Validator(scene).run(); }

}  // namespace hemiray
