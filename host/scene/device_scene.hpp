// The scene's buffers on the device: only what the effect mask needs.
#pragma once

#include <cstdint>
#include <vector>

#include "host/gpu/buffer.hpp"
#include "host/gpu/program.hpp"
#include "host/scene/flat_scene.hpp"
#include "shared/features.h"

namespace hemiray {

/// What one tree is built over: a run of triangles, and all spheres and shapes or none.
struct TreeInput {
  std::uint32_t first_triangle = 0;
  std::uint32_t triangle_count = 0;
  std::uint32_t primitive_count = 0;  ///< triangles, spheres and shapes
};

/// Uploads a FlatScene. Geometry buffers always exist (the tree is built from them); the others only where their
/// feature is on. Throws DeviceError if the device has too little memory, std::logic_error for instances without their
/// feature.
class DeviceScene {
 public:
  DeviceScene(Context& context, const FlatScene& flat, std::uint32_t features);

  [[nodiscard]] std::uint32_t features() const { return features_; }
  [[nodiscard]] std::uint32_t triangle_count() const { return triangle_count_; }
  [[nodiscard]] std::uint32_t sphere_count() const { return sphere_count_; }
  [[nodiscard]] std::uint32_t shape_count() const { return shape_count_; }
  [[nodiscard]] std::uint32_t plane_count() const { return plane_count_; }
  [[nodiscard]] std::uint32_t light_count() const { return light_count_; }
  [[nodiscard]] std::uint32_t emitter_count() const { return emitter_count_; }
  [[nodiscard]] std::uint32_t instance_count() const { return instance_count_; }
  /// Primitives of the world's own tree.
  [[nodiscard]] std::uint32_t primitive_count() const { return triangle_count_ + sphere_count_ + shape_count_; }
  [[nodiscard]] TreeInput world() const { return {0, triangle_count_, primitive_count()}; }
  /// Meshes with trees of their own.
  [[nodiscard]] const std::vector<SharedMesh>& shared_meshes() const { return shared_meshes_; }
  [[nodiscard]] const Buffer<shared::Instance>& instances() const { return instances_; }

  /// positions, triangles, spheres, shapes, triangle_count, sphere_count: what the kernels of the world's tree read.
  [[nodiscard]] Arguments geometry_arguments() const;
  /// The same for any tree, with first_triangle.
  [[nodiscard]] Arguments geometry_arguments(const TreeInput& input) const;
  /// How often a ray may have met an implicit surface where it is said not to, until now. Waits for the device.
  [[nodiscard]] std::uint64_t uncertain_roots() const;
  /// Everything of shared/scene_buffers.def but the tree, as far as the mask has it.
  [[nodiscard]] Arguments shading_arguments() const;

 private:
  std::uint32_t features_ = 0;
  std::uint32_t triangle_count_ = 0, sphere_count_ = 0, shape_count_ = 0, plane_count_ = 0;
  std::uint32_t light_count_ = 0, emitter_count_ = 0, instance_count_ = 0;
  std::vector<SharedMesh> shared_meshes_;
  Buffer<float> positions_;
  Buffer<shared::uint4> triangles_;
  Buffer<std::uint32_t> triangle_objects_;
  Buffer<float> normals_;
  Buffer<shared::float2> uvs_;
  Buffer<float> colors_;
  Buffer<shared::Sphere> spheres_;
  Buffer<shared::Shape> shapes_;
  Buffer<shared::uint4> tapes_;
  Buffer<shared::float4> patch_light_;
  Buffer<std::uint32_t> uncertain_roots_;
  Buffer<shared::Plane> planes_;
  Buffer<shared::Material> materials_;
  Buffer<shared::Light> lights_;
  Buffer<shared::Emitter> emitters_;
  Buffer<shared::Texture> textures_;
  Buffer<std::uint32_t> texels_;
  Buffer<float> srgb_to_linear_;
  Buffer<shared::Instance> instances_;
};

/// Device memory that a DeviceScene takes [bytes].
std::uint64_t predict_scene_bytes(const FlatScene& flat, std::uint32_t features);

}  // namespace hemiray
