// The equation of light, one random path after the other.
#include "tests/reference/diffuse_reference.hpp"

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

// Dimensions of a bounce's random numbers, beyond those of any light's samples.
constexpr std::uint32_t kBounce = 1U << 24U, kWhichSample = kBounce + 1;

/// Arrays of samples become random points: a sum over a fixed array is not the integral.
Scene with_random_lights(Scene scene) {
  for (Light& light : scene.lights) light.jitter = true;
  return scene;
}

/// Distributed by the cosine about `normal`, from two uniform numbers.
DVec3 cosine_direction(const DVec3& normal, double u, double v) {
  const DVec3 axis = std::abs(normal.x) < 0.5 ? DVec3(1, 0, 0) : DVec3(0, 1, 0);
  const DVec3 tangent = glm::normalize(glm::cross(axis, normal));
  const double radius = std::sqrt(u), angle = 2.0 * std::numbers::pi * v;
  return glm::normalize(radius * std::cos(angle) * tangent + radius * std::sin(angle) * glm::cross(normal, tangent) +
                        std::sqrt(1.0 - u) * normal);
}

class DiffuseTracer {
 public:
  explicit DiffuseTracer(const Scene& scene)
      : scene_(with_random_lights(scene)), world_(scene_), intersector_(world_), lights_(world_) {}

  /// Radiance that comes back along the ray, by one random path.
  [[nodiscard]] DVec3 radiance(Ray ray, RandomKey key) const {
    DVec3 sum(0.0), weight(1.0);
    for (key.ordinal = 0;; ++key.ordinal) {
      const auto hit = intersector_.nearest(ray);
      if (!hit) return sum + weight * DVec3(scene_.background);
      const Surface surface = surface_at(world_, ray, *hit);
      if (key.ordinal == 0 && surface.front) sum += surface.emission;  // later, direct_irradiance() has it
      sum += weight * surface.kd / std::numbers::pi * direct_irradiance(surface, key);
      const DVec3 random = random3(key, kBounce);
      const double survival = std::max({surface.kd.x, surface.kd.y, surface.kd.z});
      if (random.z >= survival) return sum;
      weight *= surface.kd / survival;
      ray = {surface.position_m, cosine_direction(surface.geometric_normal, random.x, random.y),
             surface.position_error_m};
    }
  }

 private:
  [[nodiscard]] DVec3 direct_irradiance(const Surface& surface, const RandomKey& key) const {
    DVec3 sum(0.0);
    for (std::size_t light = 0; light < lights_.size(); ++light) {
      const double count = lights_.sample_count(light);
      const double u = random3(key, kWhichSample + static_cast<std::uint32_t>(light)).x;
      const auto sample = lights_.sample(light, static_cast<int>(u * count), surface.position_m, key);
      if (!sample) continue;
      const double cosine = glm::dot(surface.geometric_normal, sample->direction);
      if (!(cosine > 0.0)) continue;
      const Ray shadow{surface.position_m, sample->direction, surface.position_error_m};
      if (!intersector_.occluded(shadow, sample->distance_m, sample->own)) sum += count * cosine * sample->physical;
    }
    return sum;
  }

  const Scene scene_;
  World world_;
  Intersector intersector_;
  LightList lights_;
};

}  // namespace

}  // namespace reference

Image render_diffuse_reference(const Scene& scene, const ReferenceOptions& options) {
  if (options.width <= 0 || options.height <= 0 || options.spp < 2) {
    throw InputError("reference options", "size must be positive, and samples at least 2: their spread is the error");
  }
  const reference::DiffuseTracer tracer(scene);
  Image image;
  image.width = options.width;
  image.height = options.height;
  image.layers = {{"", {"R", "G", "B"}, {}}, {"error", {"R", "G", "B"}, {}}};
  for (std::uint32_t pixel = 0; pixel < image.pixel_count(); ++pixel) {
    const int x = static_cast<int>(pixel) % options.width, y = static_cast<int>(pixel) / options.width;
    DVec3 sum(0.0), squares(0.0);
    for (int s = 0; s < options.spp; ++s) {
      const reference::RandomKey key{pixel, static_cast<std::uint32_t>(s), 0, options.seed};
      const DVec3 radiance = tracer.radiance(
          reference::camera_ray(scene.camera, options, x, y, reference::pixel_jitter(key, options.spp)), key);
      sum += radiance;
      squares += radiance * radiance;
    }
    const double n = options.spp;
    const DVec3 mean = sum / n, variance = glm::max(squares / n - mean * mean, DVec3(0.0)) / (n - 1.0);
    for (int c = 0; c < 3; ++c) {
      image.layers[0].data.push_back(static_cast<float>(mean[c]));
      image.layers[1].data.push_back(static_cast<float>(std::sqrt(variance[c])));
    }
  }
  return image;
}

}  // namespace hemiray
