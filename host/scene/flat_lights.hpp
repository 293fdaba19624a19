// Everything that sends light, as the kernels sample it: lights as given, emissive rectangles as sample arrays, all
// other emissive surfaces as one light that is sampled by area and emission.
#pragma once

#include <cstdint>
#include <vector>

#include "host/scene/flat_scene.hpp"

namespace hemiray {

/// A surface that emits, by what it sends.
struct EmitterCandidate {
  std::uint32_t primitive;
  double area_m2;
  double weight;  ///< area times mean emission
};

/// As the kernels choose among them: each by its share of the weights.
std::vector<shared::Emitter> make_emitters(const std::vector<EmitterCandidate>& candidates);

/// Fills flat.lights and flat.emitters; call the adders in the order of their declaration.
class LightCollector {
 public:
  LightCollector(const Scene& scene, FlatScene& flat) : scene_(scene), flat_(flat) {}

  /// A light of the scene; an area light's own visible quad is primitives [first_primitive, + primitive_count).
  void add_light(const Light& light, std::uint32_t first_primitive, std::uint32_t primitive_count);
  /// An object whose triangles begin at first_primitive; adds what of it is emissive.
  void add_object(const Object& object, std::uint32_t first_primitive);
  /// Emissive spheres of the scene.
  void add_spheres();
  /// Adds the light that stands for all emitters, if there are any.
  void finish();

 private:
  void append(shared::Light light);
  void add_rectangle(std::uint32_t first_primitive, const Material& material);
  [[nodiscard]] DVec3 position(std::uint32_t vertex) const;

  const Scene& scene_;
  FlatScene& flat_;
  std::vector<EmitterCandidate> candidates_;
  std::uint32_t sample_count_ = 0;
};

/// Samples an emissive rectangle gets per direction: its array is this many by this many, jittered.
inline constexpr int kRectangleSamples = 4;

}  // namespace hemiray
