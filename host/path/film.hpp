// The picture on the device: sums of radiance per pixel and the geometric layers of the first sample; and how a picture
// is made from them.
#pragma once

#include <cstdint>
#include <vector>

#include "host/base/image.hpp"
#include "host/gpu/buffer.hpp"
#include "host/path/path_sums.hpp"

namespace hemiray {

/// What a picture is developed from, on the host; row-major, one entry a pixel. What the effect mask leaves out is
/// empty.
struct FilmData {
  int width = 0, height = 0;                           ///< [pixels]
  std::vector<shared::float4> direct;                  ///< sums over the passes: rgb [W/m^2/sr], w = coverage
  std::vector<shared::float4> reflection, refraction;  ///< sums over the passes: rgb [W/m^2/sr]
  std::vector<shared::float4> normal_depth;            ///< of the first sample: xyz normal, w distance [m]
  std::vector<shared::float4> albedo_object;           ///< of the first sample: rgb kd, w = object + 1
};

/// The layers "" (R, G, B, A), depth, normal, albedo, id, direct, reflection, refraction; sums divided by `passes`.
/// What the data lack is zero.
Image develop(const FilmData& data, int passes);

/// The layers that the engines write directly, for the whole picture.
class GeometryLayers {
 public:
  GeometryLayers(Context& context, int width, int height);

  /// aov_normal_depth and aov_albedo_object.
  [[nodiscard]] Arguments arguments() const;
  [[nodiscard]] const Buffer<shared::float4>& normal_depth() const { return normal_depth_; }
  [[nodiscard]] const Buffer<shared::float4>& albedo_object() const { return albedo_object_; }

 private:
  Buffer<shared::float4> normal_depth_, albedo_object_;
};

class Film {
 public:
  Film(Context& context, std::uint32_t features, int width, int height);

  /// Adds the sums of slots [0, count) to pixels [first_pixel, + count); `kernel` is film_accumulate.
  void accumulate(Kernel& kernel, const PathSums& sums, std::uint32_t first_pixel, std::uint32_t count);

  /// aov_normal_depth and aov_albedo_object, which the engines write directly.
  [[nodiscard]] Arguments aov_arguments() const { return geometry_.arguments(); }

  /// The picture after `passes` passes; layers as develop() says.
  [[nodiscard]] Image develop(int passes) const;

 private:
  Context* context_;
  int width_, height_;
  Buffer<shared::float4> direct_, reflection_, refraction_;
  GeometryLayers geometry_;
};

}  // namespace hemiray
