// The light list of the reference tracer: the scene's lights, emissive rectangles, and all other emitters as one light.
#pragma once

#include <optional>
#include <vector>

#include "tests/reference/reference_random.hpp"
#include "tests/reference/reference_world.hpp"

namespace hemiray::reference {

/// What one light sample sends to a point.
struct LightSample {
  DVec3 direction{0.0};          ///< unit length, from the point to the light
  double distance_m = 0.0;       ///< infinity for directional lights
  DVec3 physical{0.0};           ///< irradiance at a patch that faces the sample [W/m^2]
  DVec3 phong{0.0};              ///< L of the source's formula
  std::vector<PrimitiveId> own;  ///< the light's flat surface, which cannot hide it
};

/// All lights in the order in which their samples are numbered.
class LightList {
 public:
  explicit LightList(const World& world);

  [[nodiscard]] std::size_t size() const { return lights_.size(); }
  [[nodiscard]] int sample_count(std::size_t light) const;

  /// Sample `k` of a light as seen from `point_m`; empty where the light sends nothing there.
  [[nodiscard]] std::optional<LightSample> sample(std::size_t light, int k, const DVec3& point_m,
                                                  const RandomKey& key) const;

 private:
  enum class Type { point, directional, spot, area, emitters };
  struct Entry {
    Type type = Type::point;
    DVec3 position{0.0}, direction{0.0}, intensity{0.0};
    double cos_inner = 1.0, cos_outer = 0.0;
    DVec3 edge_u{0.0}, edge_v{0.0}, normal{0.0};
    int samples_u = 1, samples_v = 1;
    bool jitter = false;
    std::vector<PrimitiveId> own;
    std::uint32_t first_index = 0;  ///< number of samples of all lights before
  };
  struct Emitter {
    PrimitiveId primitive;
    double area_m2 = 0.0;
    double weight = 0.0;
  };
  void add_scene_light(const Light& light);
  void add_rectangles();
  void add_emitters();
  void push(Entry entry);
  [[nodiscard]] LightSample sample_area(const Entry& light, int k, const DVec3& point, const RandomKey& key) const;
  [[nodiscard]] std::optional<LightSample> sample_emitters(const Entry& light, int k, const DVec3& point,
                                                           const RandomKey& key) const;

  const World& world_;
  std::vector<Entry> lights_;
  std::vector<Emitter> emitters_;
  double total_weight_ = 0.0;
};

}  // namespace hemiray::reference
