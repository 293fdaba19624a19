// The patches drawn on the faces of hemicubes, in place of rays.
#pragma once

#include <cstdint>

#include "host/gpu/buffer.hpp"
#include "host/gpu/program.hpp"
#include "host/radiosity/patch_mesh.hpp"

namespace hemiray {

/// Item buffers with depth (kernels/raster/item_buffer.cl). The Context must outlive it.
class HemicubeRaster {
 public:
  /// `resolution`: cells along an edge of the cubes.
  HemicubeRaster(Context& context, const PatchMesh& mesh, std::uint32_t resolution);

  /// What every cell of the hemicubes over the sides `rows` shows: numbered as in shared/radiosity_types.h, a side or
  /// HR_NO_SIDE.
  void draw(const Buffer<std::uint32_t>& rows, const shared::HemicubeParams& cube, Buffer<std::uint32_t>& seen);

 private:
  Context* context_;
  Program program_;
  std::uint32_t groups_, workers_;
  Buffer<float> corners_, bounds_;
  Buffer<float> depths_;
  Buffer<std::int32_t> items_;
};

}  // namespace hemiray
