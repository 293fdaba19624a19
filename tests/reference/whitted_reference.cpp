// Whitted's recursion and the film.
#include "tests/reference/whitted_reference.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "host/base/error.hpp"
#include "tests/reference/reference_camera.hpp"
#include "tests/reference/reference_lights.hpp"
#include "tests/reference/reference_surface.hpp"

namespace hemiray {

namespace reference {

namespace {

/// The light that comes back along a ray, by the way it took at the first surface.
struct Radiance {
  DVec3 direct{0.0}, reflection{0.0}, refraction{0.0};
  [[nodiscard]] DVec3 sum() const { return direct + reflection + refraction; }
};

/// Reflectance of a smooth dielectric for unpolarised light; `eta` = index before / index behind the surface.
double fresnel_reflectance(double cos_in, double cos_out, double eta) {
  const double perpendicular = (eta * cos_in - cos_out) / (eta * cos_in + cos_out);
  const double parallel = (cos_in - eta * cos_out) / (cos_in + eta * cos_out);
  return (perpendicular * perpendicular + parallel * parallel) / 2.0;
}

/// Where a ray goes on inside, and how much is reflected; `total` under total internal reflection.
struct Transmission {
  bool total = false;
  DVec3 direction{0.0};
  double reflectance = 1.0;
};

Transmission transmit_about(const DVec3& direction, const DVec3& normal, double eta) {
  const double cos_in = -glm::dot(direction, normal);
  const double sin2_out = eta * eta * (1.0 - cos_in * cos_in);
  if (sin2_out >= 1.0) return {true, DVec3(0.0), 1.0};
  const double cos_out = std::sqrt(1.0 - sin2_out);
  const DVec3 out = glm::normalize(eta * direction + (eta * cos_in - cos_out) * normal);
  return {false, out, fresnel_reflectance(cos_in, cos_out, eta)};
}

Transmission transmit(const DVec3& direction, const Surface& surface) {
  const double eta = surface.front ? 1.0 / surface.ior : surface.ior;
  const bool shading_faces = glm::dot(direction, surface.shading_normal) < 0.0;
  Transmission result =
      transmit_about(direction, shading_faces ? surface.shading_normal : surface.geometric_normal, eta);
  if (!result.total && glm::dot(result.direction, surface.geometric_normal) >= 0.0) {
    result = transmit_about(direction, surface.geometric_normal, eta);
  }
  return result;
}

DVec3 reflect(const DVec3& direction, const Surface& surface) {
  const auto about = [&](const DVec3& n) { return glm::normalize(direction - 2.0 * glm::dot(direction, n) * n); };
  const DVec3 result = about(surface.shading_normal);
  if (glm::dot(result, surface.geometric_normal) > 0.0) return result;
  return about(surface.geometric_normal);
}

bool any_positive(const DVec3& v) { return v.x > 0.0 || v.y > 0.0 || v.z > 0.0; }

/// Traces the samples of one scene.
class Tracer {
 public:
  Tracer(const Scene& scene, const ReferenceOptions& options)
      : scene_(scene), options_(options), world_(scene), intersector_(world_), lights_(world_) {}

  [[nodiscard]] const World& world() const { return world_; }
  [[nodiscard]] const Intersector& intersector() const { return intersector_; }

  /// One camera ray and everything it spawns; `key.ordinal` is 0.
  Radiance trace_sample(const Ray& ray, const RandomKey& key) {
    key_ = key;
    next_ordinal_ = 1;
    return trace(ray, 0, 0, DVec3(1.0));
  }

 private:
  Radiance trace(const Ray& ray, int bounce, std::uint32_t ordinal, const DVec3& throughput);
  [[nodiscard]] DVec3 local_light(const Ray& ray, const Surface& surface, const PrimitiveId& own,
                                  std::uint32_t ordinal) const;
  [[nodiscard]] DVec3 response(const Ray& ray, const Surface& surface, const LightSample& sample) const;

  const Scene& scene_;
  const ReferenceOptions& options_;
  World world_;
  Intersector intersector_;
  LightList lights_;
  RandomKey key_;
  std::uint32_t next_ordinal_ = 1;
};

/// What a light sample contributes if nothing hides it.
DVec3 Tracer::response(const Ray& ray, const Surface& surface, const LightSample& sample) const {
  const DVec3 half = glm::normalize(sample.direction - ray.direction);
  const double cos_surface = std::max(glm::dot(surface.shading_normal, sample.direction), 0.0);
  const double highlight = std::pow(std::max(glm::dot(surface.shading_normal, half), 0.0), surface.exponent);
  if (scene_.shading == Shading::phong) {
    return surface.kd * sample.phong * cos_surface + surface.ks * sample.phong * highlight;
  }
  const double normalisation = (surface.exponent + 8.0) / (8.0 * std::numbers::pi);
  const DVec3 brdf = surface.kd / std::numbers::pi + surface.ks * (normalisation * highlight);
  return brdf * sample.physical * cos_surface;
}

/// Emission, ambient and direct light at a hit.
DVec3 Tracer::local_light(const Ray& ray, const Surface& surface, const PrimitiveId& own, std::uint32_t ordinal) const {
  const bool lifted = surface.lift_m != DVec3(0.0);
  const DVec3 start = surface.position_m + surface.lift_m;
  const DVec3& horizon = lifted ? surface.shading_normal : surface.geometric_normal;
  DVec3 sum = surface.ka * DVec3(scene_.ambient);
  if (surface.front) sum += surface.emission;
  RandomKey key = key_;
  key.ordinal = ordinal;
  for (std::size_t light = 0; light < lights_.size(); ++light) {
    for (int k = 0; k < lights_.sample_count(light); ++k) {
      const auto sample = lights_.sample(light, k, start, key);
      if (!sample || !(glm::dot(horizon, sample->direction) > 0.0)) continue;
      const DVec3 contribution = response(ray, surface, *sample);
      if (!any_positive(contribution)) continue;
      const Ray shadow{start, sample->direction, surface.position_error_m};
      std::vector<PrimitiveId> ignored = sample->own;
      if (lifted) ignored.push_back(own);
      if (!intersector_.occluded(shadow, sample->distance_m, ignored)) sum += contribution;
    }
  }
  return sum;
}

Radiance Tracer::trace(const Ray& ray, int bounce, std::uint32_t ordinal, const DVec3& throughput) {
  Radiance result;
  const auto hit = intersector_.nearest(ray);
  if (!hit) {
    result.direct = DVec3(scene_.background);
    return result;
  }
  const Surface surface = surface_at(world_, ray, *hit);
  result.direct = local_light(ray, surface, hit->primitive, ordinal);
  if (bounce >= options_.depth) return result;

  DVec3 kr = surface.kr;
  DVec3 kt = surface.kt;
  Transmission transmission;
  if (any_positive(surface.kt)) {
    transmission = transmit(ray.direction, surface);
    if (surface.fresnel) {
      kr *= transmission.reflectance;
      kt *= 1.0 - transmission.reflectance;
    }
    if (transmission.total) kt = DVec3(0.0);
  }
  const auto follow = [&](const DVec3& weight, const DVec3& direction) {
    if (!any_positive(throughput * weight)) return DVec3(0.0);
    const Ray next{surface.position_m, direction, surface.position_error_m};
    const std::uint32_t next_ordinal = next_ordinal_++;
    return weight * trace(next, bounce + 1, next_ordinal, throughput * weight).sum();
  };
  result.reflection = follow(kr, reflect(ray.direction, surface));
  result.refraction = follow(kt, transmission.direction);
  return result;
}

/// The image's layers, all zero.
Image blank_image(const ReferenceOptions& options) {
  Image image;
  image.width = options.width;
  image.height = options.height;
  const std::vector<std::string> rgb{"R", "G", "B"};
  image.layers = {{"", {"R", "G", "B", "A"}, {}},
                  {"depth", {"Z"}, {}},
                  {"normal", {"X", "Y", "Z"}, {}},
                  {"albedo", rgb, {}},
                  {"id", {"id"}, {}},
                  {"direct", rgb, {}},
                  {"reflection", rgb, {}},
                  {"refraction", rgb, {}}};
  for (Layer& layer : image.layers) layer.data.assign(image.pixel_count() * layer.channels.size(), 0.0F);
  return image;
}

void store(Image& image, const std::string& name, std::size_t pixel, const DVec3& value) {
  for (Layer& layer : image.layers) {
    if (layer.name != name) continue;
    const std::size_t channels = layer.channels.size();
    for (std::size_t c = 0; c < std::min<std::size_t>(channels, 3); ++c) {
      layer.data[pixel * channels + c] = static_cast<float>(value[static_cast<int>(c)]);
    }
  }
}

/// The layers that show the first surface, from sample 0.
void store_first_surface(Image& image, const Tracer& tracer, std::size_t pixel, const Ray& ray, const Hit& hit) {
  const Surface surface = surface_at(tracer.world(), ray, hit);
  store(image, "depth", pixel, DVec3(hit.t_m));
  store(image, "normal", pixel, surface.shading_normal);
  store(image, "albedo", pixel, surface.kd);
  store(image, "id", pixel, DVec3(static_cast<double>(tracer.world().object_id(hit.primitive))));
}

void render_pixel(Image& image, Tracer& tracer, const ReferenceOptions& options, int x, int y) {
  const auto pixel = static_cast<std::uint32_t>(y * options.width + x);
  Radiance total;
  int hits = 0;
  for (int s = 0; s < options.spp; ++s) {
    const RandomKey key{pixel, static_cast<std::uint32_t>(s), 0, options.seed};
    const Ray ray = camera_ray(tracer.world().scene.camera, options, x, y, pixel_jitter(key, options.spp));
    const Radiance radiance = tracer.trace_sample(ray, key);
    total.direct += radiance.direct;
    total.reflection += radiance.reflection;
    total.refraction += radiance.refraction;
    const auto hit = tracer.intersector().nearest(ray);
    if (!hit) continue;
    ++hits;
    if (s == 0) store_first_surface(image, tracer, pixel, ray, *hit);
  }
  const double count = options.spp;
  store(image, "", pixel, total.sum() / count);
  image.layers[0].data[std::size_t{pixel} * 4 + 3] = static_cast<float>(hits / count);
  store(image, "direct", pixel, total.direct / count);
  store(image, "reflection", pixel, total.reflection / count);
  store(image, "refraction", pixel, total.refraction / count);
}

}  // namespace

}  // namespace reference

Image render_reference(const Scene& scene, const ReferenceOptions& options) {
  if (options.width <= 0 || options.height <= 0 || options.spp <= 0 || options.depth < 0) {
    throw InputError("reference options", "size and spp must be positive and depth not negative");
  }
  Image image = reference::blank_image(options);
  reference::Tracer tracer(scene, options);
  for (int y = 0; y < options.height; ++y) {
    for (int x = 0; x < options.width; ++x) reference::render_pixel(image, tracer, options, x, y);
  }
  return image;
}

}  // namespace hemiray
