#include "host/radiosity/hemicube_raster.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <span>
#include <vector>

namespace hemiray {
namespace {

constexpr std::size_t kLanes = 16, kGroup = kLanes * kLanes;        // triangles a chunk, and a group of chunks
constexpr std::uint64_t kPictureBytes = std::uint64_t{256} << 20U;  // for the faces being drawn, at most

struct Chunks {
  std::vector<float> corners;  ///< rows a.x to c.z, kLanes each, a chunk
  std::vector<float> bounds;   ///< rows lo.x to hi.z, kLanes each, a group
};

// The last group is filled up with triangles that are points, which nothing shows.
Chunks chunks_of(const FlatScene& flat) {
  const std::size_t count = flat.triangles.size(), groups = (count + kGroup - 1) / kGroup;
  Chunks chunks;
  chunks.corners.resize(groups * kGroup * 9);
  chunks.bounds.resize(groups * kLanes * 6);
  for (std::size_t chunk = 0; chunk < groups * kLanes; chunk++) {
    std::array<float, 6> box;
    std::fill_n(box.begin(), 3, std::numeric_limits<float>::infinity());
    std::fill_n(box.begin() + 3, 3, -std::numeric_limits<float>::infinity());
    for (std::size_t lane = 0; lane < kLanes; lane++) {
      const std::size_t i = chunk * kLanes + lane;
      const shared::uint4 t = flat.triangles[std::min(i, count - 1)];
      for (std::size_t k = 0; k < 3; k++) {
        const std::uint32_t vertex = i >= count || k == 0 ? t.x : (k == 1 ? t.y : t.z);
        for (std::size_t axis = 0; axis < 3; axis++) {
          const float p = flat.positions[std::size_t{3} * vertex + axis];
          chunks.corners[chunk * kLanes * 9 + (3 * k + axis) * kLanes + lane] = p;
          box[axis] = std::min(box[axis], p);
          box[3 + axis] = std::max(box[3 + axis], p);
        }
      }
    }
    for (std::size_t row = 0; row < 6; row++) {
      chunks.bounds[chunk / kLanes * kLanes * 6 + row * kLanes + chunk % kLanes] = box[row];
    }
  }
  return chunks;
}

}  // namespace

HemicubeRaster::HemicubeRaster(Context& context, const PatchMesh& mesh, std::uint32_t resolution)
    : context_(&context),
      program_(context, "item buffers", {"raster/item_buffer.cl"},
               {0, false, context.profile().explicit_vectors != 0 ? "" : "-DHR_EXPLICIT_VECTORS=0"}) {
  const Chunks chunks = chunks_of(mesh.flat);
  corners_ = Buffer<float>(context, "patch corners", std::span<const float>(chunks.corners));
  bounds_ = Buffer<float>(context, "patch bounds", std::span<const float>(chunks.bounds));
  groups_ = static_cast<std::uint32_t>(chunks.bounds.size() / (kLanes * 6));
  const std::uint64_t stride = (resolution + kLanes - 1) / kLanes * kLanes, cells = resolution * stride;
  const std::uint64_t most = std::min(kPictureBytes, context.device().max_allocation_bytes) / (cells * sizeof(float));
  workers_ = static_cast<std::uint32_t>(std::clamp<std::uint64_t>(most, 1, context.profile().chunks));
  depths_ = Buffer<float>(context, "item depths", workers_ * cells);
  items_ = Buffer<std::int32_t>(context, "items", workers_ * cells);
}

void HemicubeRaster::draw(const Buffer<std::uint32_t>& rows, const shared::HemicubeParams& cube,
                          Buffer<std::uint32_t>& seen) {
  launch(
      *context_, program_.kernel("raster_draw_hemicubes"), workers_,
      arguments(arg("corners", corners_), arg("bounds", bounds_), arg("groups_of_chunks", groups_), arg("rows", rows),
                arg("depths", depths_), arg("items", items_), arg("seen", seen), arg("cube", cube)));
}

}  // namespace hemiray
