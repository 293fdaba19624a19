// Builds the light list and takes samples from it.
#include "tests/reference/reference_lights.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "tests/reference/reference_surface.hpp"

namespace hemiray::reference {

namespace {

constexpr double kMinConeWidth = 0.001;  // glTF: keeps a spot with equal angles finite

bool emits(const Material& material) { return material.emission != Vec3(0.0F); }

/// An emissive object that is sampled as an n x m array.
bool is_array_rectangle(const Scene& scene, const Object& object) {
  if (!scene.meshes.at(object.mesh).rectangle) return false;
  const Material& material = scene.materials.at(material_of(scene, object, 0));
  return emits(material) && material.emission_texture == kNone;
}

}  // namespace

LightList::LightList(const World& world) : world_(world) {
  for (const Light& light : world.scene.lights) add_scene_light(light);
  add_rectangles();
  add_emitters();
}

int LightList::sample_count(std::size_t light) const { return lights_[light].samples_u * lights_[light].samples_v; }

void LightList::push(Entry entry) {
  if (!lights_.empty()) {
    entry.first_index = lights_.back().first_index + static_cast<std::uint32_t>(sample_count(lights_.size() - 1));
  }
  lights_.push_back(std::move(entry));
}

void LightList::add_scene_light(const Light& light) {
  Entry entry;
  entry.position = light.position;
  entry.direction = light.direction;
  entry.intensity = DVec3(light.intensity);
  switch (light.kind) {
    case LightKind::point:
      break;
    case LightKind::directional:
      entry.type = Type::directional;
      break;
    case LightKind::spot:
      entry.type = Type::spot;
      entry.cos_inner = std::cos(glm::radians(light.inner_angle_deg));
      entry.cos_outer = std::cos(glm::radians(light.outer_angle_deg));
      break;
    case LightKind::area: {
      entry.type = Type::area;
      entry.edge_u = light.edge_u;
      entry.edge_v = light.edge_v;
      entry.normal = glm::normalize(glm::cross(light.edge_u, light.edge_v));
      entry.samples_u = light.samples_u;
      entry.samples_v = light.samples_v;
      entry.jitter = light.jitter;
      const auto index = static_cast<std::size_t>(&light - world_.scene.lights.data());
      for (std::size_t i = 0; i < world_.quads.size(); ++i) {
        if (world_.quads[i].light == index) entry.own.push_back({Kind::quad, i});
      }
      break;
    }
  }
  push(std::move(entry));
}

void LightList::add_rectangles() {
  for (std::size_t i = 0; i < world_.scene.objects.size(); ++i) {
    const Object& object = world_.scene.objects[i];
    if (!is_array_rectangle(world_.scene, object)) continue;
    const Mesh& mesh = world_.scene.meshes[object.mesh];
    Entry entry;
    entry.type = Type::area;
    entry.position = world_position(object, mesh.positions.at(0));
    entry.edge_u = world_position(object, mesh.positions.at(1)) - entry.position;
    entry.edge_v = world_position(object, mesh.positions.at(3)) - entry.position;
    entry.normal = glm::normalize(glm::cross(entry.edge_u, entry.edge_v));
    // A mirroring transform turns the corners' order, not the side that shines.
    if (glm::determinant(glm::dmat3(object.to_world)) < 0.0) entry.normal = -entry.normal;
    entry.intensity = DVec3(world_.scene.materials.at(material_of(world_.scene, object, 0)).emission);
    entry.samples_u = entry.samples_v = 4;
    entry.jitter = true;
    for (std::size_t t = 0; t < world_.triangles.size(); ++t) {
      if (world_.triangles[t].object == i) entry.own.push_back({Kind::triangle, t});
    }
    push(std::move(entry));
  }
}

void LightList::add_emitters() {
  const auto add = [this](const PrimitiveId& primitive, double area_m2, std::size_t material) {
    const Vec3 emission = world_.scene.materials.at(material).emission;
    const double weight = area_m2 * (static_cast<double>(emission.r) + emission.g + emission.b) / 3.0;
    if (!(weight > 0.0)) return;
    emitters_.push_back({primitive, area_m2, weight});
    total_weight_ += weight;
  };
  for (std::size_t t = 0; t < world_.triangles.size(); ++t) {
    const WorldTriangle& triangle = world_.triangles[t];
    if (is_array_rectangle(world_.scene, world_.scene.objects[triangle.object])) continue;
    add({Kind::triangle, t}, triangle.area_m2, triangle.material);
  }
  for (std::size_t s = 0; s < world_.scene.spheres.size(); ++s) {
    const Sphere& sphere = world_.scene.spheres[s];
    add({Kind::sphere, s}, 4.0 * std::numbers::pi * sphere.radius * sphere.radius, sphere.material);
  }
  if (emitters_.empty()) return;
  Entry entry;
  entry.type = Type::emitters;
  entry.samples_u = world_.scene.emitter_samples;
  push(std::move(entry));
}

std::optional<LightSample> LightList::sample(std::size_t light, int k, const DVec3& point_m,
                                             const RandomKey& key) const {
  const Entry& entry = lights_[light];
  if (entry.type == Type::area) return sample_area(entry, k, point_m, key);
  if (entry.type == Type::emitters) return sample_emitters(entry, k, point_m, key);
  LightSample result;
  if (entry.type == Type::directional) {
    result.direction = -entry.direction;
    result.distance_m = std::numeric_limits<double>::infinity();
    result.physical = result.phong = entry.intensity;
    return result;
  }
  const DVec3 to_light = entry.position - point_m;
  result.distance_m = glm::length(to_light);
  if (!(result.distance_m > 0.0)) return std::nullopt;
  result.direction = to_light / result.distance_m;
  double cone = 1.0;
  if (entry.type == Type::spot) {
    const double cos_angle = -glm::dot(result.direction, entry.direction);
    const double width = std::max(kMinConeWidth, entry.cos_inner - entry.cos_outer);
    const double share = std::clamp((cos_angle - entry.cos_outer) / width, 0.0, 1.0);
    cone = share * share;
  }
  result.phong = entry.intensity * cone;
  result.physical = result.phong / (result.distance_m * result.distance_m);
  return result;
}

LightSample LightList::sample_area(const Entry& light, int k, const DVec3& point, const RandomKey& key) const {
  glm::dvec2 offset(0.5);
  if (light.jitter) offset = glm::dvec2(random3(key, 1U + light.first_index + static_cast<std::uint32_t>(k)));
  const double u = (k % light.samples_u + offset.x) / light.samples_u;
  const double v = (k / light.samples_u + offset.y) / light.samples_v;
  const DVec3 to_light = light.position + u * light.edge_u + v * light.edge_v - point;
  const double count = static_cast<double>(light.samples_u) * light.samples_v;
  const double area_m2 = glm::length(glm::cross(light.edge_u, light.edge_v));
  LightSample result;
  result.distance_m = glm::length(to_light);
  result.direction = to_light / result.distance_m;
  const double cos_light = std::max(-glm::dot(result.direction, light.normal), 0.0);
  result.phong = light.intensity / count;
  result.physical = light.intensity * cos_light * area_m2 / count / (result.distance_m * result.distance_m);
  result.own = light.own;
  return result;
}

std::optional<LightSample> LightList::sample_emitters(const Entry& light, int k, const DVec3& point,
                                                      const RandomKey& key) const {
  const double count = light.samples_u;
  const DVec3 r = random3(key, 1U + light.first_index + static_cast<std::uint32_t>(k));
  const double target = (k + r.x) / count * total_weight_;
  std::size_t chosen = 0;
  double cumulative = emitters_[0].weight;
  while (chosen + 1 < emitters_.size() && cumulative <= target) cumulative += emitters_[++chosen].weight;
  const Emitter& emitter = emitters_[chosen];

  LightSample result;
  DVec3 position;
  DVec3 normal;
  DVec3 emission;
  if (emitter.primitive.kind == Kind::triangle) {
    const WorldTriangle& triangle = world_.triangles[emitter.primitive.index];
    const double su = std::sqrt(r.y);
    const DVec3 weights(1.0 - su, su * (1.0 - r.z), su * r.z);
    position = triangle.corners[0] * weights.x + triangle.corners[1] * weights.y + triangle.corners[2] * weights.z;
    normal = triangle.normal;
    emission = triangle_emission(world_, triangle, weights);
    result.own.push_back(emitter.primitive);
  } else {
    const Sphere& sphere = world_.scene.spheres[emitter.primitive.index];
    const double z = 1.0 - 2.0 * r.y;
    const double phi = 2.0 * std::numbers::pi * r.z;
    const double radial = std::sqrt(std::max(0.0, 1.0 - z * z));
    normal = {radial * std::cos(phi), radial * std::sin(phi), z};
    position = sphere.center + sphere.radius * normal;
    emission = DVec3(world_.scene.materials.at(sphere.material).emission);
  }
  const DVec3 to_light = position - point;
  result.distance_m = glm::length(to_light);
  if (!(result.distance_m > 0.0)) return std::nullopt;
  result.direction = to_light / result.distance_m;
  const double cos_light = -glm::dot(result.direction, normal);
  if (!(cos_light > 0.0)) return std::nullopt;
  const double pdf_per_m2 = emitter.weight / total_weight_ / emitter.area_m2;
  result.phong = emission / count;
  result.physical = emission * cos_light / (result.distance_m * result.distance_m) / count / pdf_per_m2;
  return result;
}

}  // namespace hemiray::reference
