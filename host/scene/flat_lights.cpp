#include "host/scene/flat_lights.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace hemiray {
namespace {

// glTF's spot fall-off divides by at least this much difference of cosines.
constexpr double kMinConeWidth = 0.001;

shared::float4 to_float4(const DVec3& v, double w) {
  return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z), static_cast<float>(w)};
}

double mean(const Vec3& v) { return (static_cast<double>(v.x) + v.y + v.z) / 3.0; }

// Does a material shine?
bool is_emissive(const Material& material) { return mean(material.emission) > 0.0; }

void set_rectangle(shared::Light& light, const DVec3& corner, const DVec3& edge_u, const DVec3& edge_v,
                   const Vec3& radiance) {
  const DVec3 cross = glm::cross(edge_u, edge_v);
  const double area = glm::length(cross);
  light.kind = HR_LIGHT_AREA;
  light.position = to_float4(corner, 0.0);
  light.direction = to_float4(cross / area, 0.0);
  light.intensity = to_float4(DVec3(radiance), area / (static_cast<double>(light.samples_u) * light.samples_v));
  light.edge_u = to_float4(edge_u, 0.0);
  light.edge_v = to_float4(edge_v, 0.0);
}

}  // namespace

std::vector<shared::Emitter> make_emitters(const std::vector<EmitterCandidate>& candidates) {
  std::vector<shared::Emitter> emitters;
  double total = 0.0;
  for (const EmitterCandidate& c : candidates) total += c.weight;
  double sum = 0.0;
  for (const EmitterCandidate& c : candidates) {
    sum += c.weight;
    shared::Emitter emitter{};
    emitter.primitive = c.primitive;
    emitter.cumulative = static_cast<float>(sum / total);
    emitter.inverse_pdf = static_cast<float>(c.area_m2 * total / c.weight);
    emitters.push_back(emitter);
  }
  if (!emitters.empty()) emitters.back().cumulative = 1.0F;
  return emitters;
}

DVec3 LightCollector::position(std::uint32_t vertex) const {
  const float* p = &flat_.positions[std::size_t{3} * vertex];
  return {p[0], p[1], p[2]};
}

void LightCollector::append(shared::Light light) {
  light.sample_count = light.samples_u * light.samples_v;
  light.first_sample = sample_count_;
  sample_count_ += light.sample_count;
  flat_.lights.push_back(light);
}

void LightCollector::add_light(const Light& light, std::uint32_t first_primitive, std::uint32_t primitive_count) {
  shared::Light flat{};
  flat.samples_u = 1;
  flat.samples_v = 1;
  flat.first_primitive = first_primitive;
  flat.primitive_count = primitive_count;
  flat.intensity = to_float4(DVec3(light.intensity), 0.0);
  flat.position = to_float4(light.position, 0.0);
  flat.direction = to_float4(light.direction, 0.0);
  switch (light.kind) {
    case LightKind::point:
      flat.kind = HR_LIGHT_POINT;
      break;
    case LightKind::directional:
      flat.kind = HR_LIGHT_DIRECTIONAL;
      break;
    case LightKind::spot: {
      const double cos_outer = std::cos(light.outer_angle_deg * std::numbers::pi / 180.0);
      const double cos_inner = std::cos(light.inner_angle_deg * std::numbers::pi / 180.0);
      flat.kind = HR_LIGHT_SPOT;
      flat.position.w = static_cast<float>(cos_outer);
      flat.direction.w = static_cast<float>(1.0 / std::max(kMinConeWidth, cos_inner - cos_outer));
      break;
    }
    case LightKind::area:
      flat.samples_u = static_cast<std::uint32_t>(light.samples_u);
      flat.samples_v = static_cast<std::uint32_t>(light.samples_v);
      flat.jitter = light.jitter ? 1 : 0;
      set_rectangle(flat, light.position, light.edge_u, light.edge_v, light.intensity);
      break;
  }
  append(flat);
}

void LightCollector::add_rectangle(std::uint32_t first_primitive, const Material& material) {
  const shared::uint4 first = flat_.triangles[first_primitive];
  const shared::uint4 second = flat_.triangles[first_primitive + 1];
  // (0,1,2),(0,2,3), or with a mirroring transform (0,2,1),(0,3,2): the front is cross(edge_u, edge_v) either way.
  const bool mirrored = second.z == first.y;
  shared::Light light{};
  light.samples_u = kRectangleSamples;
  light.samples_v = kRectangleSamples;
  light.jitter = 1;
  light.first_primitive = first_primitive;
  light.primitive_count = 2;
  const DVec3 corner = position(first.x);
  const DVec3 to_1 = position(mirrored ? first.z : first.y) - corner;
  const DVec3 to_3 = position(mirrored ? second.y : second.z) - corner;
  set_rectangle(light, corner, mirrored ? to_3 : to_1, mirrored ? to_1 : to_3, material.emission);
  append(light);
}

void LightCollector::add_object(const Object& object, std::uint32_t first_primitive) {
  const Mesh& mesh = scene_.meshes[object.mesh];
  if (mesh.rectangle && mesh.triangles.size() == 2) {
    const Material& material = scene_.materials[flat_.triangles[first_primitive].w];
    if (is_emissive(material) && material.emission_texture == kNone) {
      add_rectangle(first_primitive, material);
      return;
    }
  }
  for (std::uint32_t t = 0; t < mesh.triangles.size(); t++) {
    const shared::uint4 v = flat_.triangles[first_primitive + t];
    const Material& material = scene_.materials[v.w];
    if (!is_emissive(material)) continue;
    const DVec3 a = position(v.x);
    const double area = 0.5 * glm::length(glm::cross(position(v.y) - a, position(v.z) - a));
    if (area > 0.0) candidates_.push_back({first_primitive + t, area, area * mean(material.emission)});
  }
}

void LightCollector::add_spheres() {
  for (std::uint32_t i = 0; i < flat_.spheres.size(); i++) {
    const Material& material = scene_.materials[flat_.spheres[i].material];
    if (!is_emissive(material)) continue;
    const double radius = flat_.spheres[i].center_radius.w;
    const double area = 4.0 * std::numbers::pi * radius * radius;
    candidates_.push_back(
        {static_cast<std::uint32_t>(flat_.triangles.size()) + i, area, area * mean(material.emission)});
  }
}

void LightCollector::finish() {
  if (candidates_.empty()) return;
  flat_.emitters = make_emitters(candidates_);
  shared::Light light{};
  light.kind = HR_LIGHT_EMITTERS;
  light.samples_u = static_cast<std::uint32_t>(scene_.emitter_samples);
  light.samples_v = 1;
  light.jitter = 1;
  append(light);
}

}  // namespace hemiray
