// The picture on the device: sums of radiance per pixel and the geometric layers of the first sample.
#pragma once

#include <cstdint>

#include "host/base/image.hpp"
#include "host/gpu/buffer.hpp"
#include "host/path/path_sums.hpp"

namespace hemiray {

class Film {
 public:
  Film(Context& context, std::uint32_t features, int width, int height);

  /// Adds the sums of slots [0, count) to pixels [first_pixel, + count); `kernel` is film_accumulate.
  void accumulate(Kernel& kernel, const PathSums& sums, std::uint32_t first_pixel, std::uint32_t count);

  /// aov_normal_depth and aov_albedo_object, which the engines write directly.
  [[nodiscard]] Arguments aov_arguments() const;

  /// The layers "" (R, G, B, A), depth, normal, albedo, id, direct, reflection, refraction; sums divided by `passes`.
  /// What the effect mask leaves out is zero.
  [[nodiscard]] Image develop(int passes) const;

 private:
  Context* context_;
  int width_, height_;
  Buffer<shared::real4> direct_, reflection_, refraction_;
  Buffer<shared::float4> normal_depth_, albedo_object_;
};

}  // namespace hemiray
