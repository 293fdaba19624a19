// How much device memory a tree takes, before it is built.
#pragma once

#include <cstdint>

#include "host/bvh/accel_config.hpp"
#include "host/scene/flat_scene.hpp"

namespace hemiray {

struct AccelMemory {
  std::uint64_t tree = 0;  ///< bytes of nodes, blocks and regions, which stay
  std::uint64_t peak = 0;  ///< most bytes at any time of the build, the tree included
};

/// For `primitives` triangles and spheres of usual shape: how full the blocks get depends on the scene, so the tree is
/// an estimate; what the build works in is known.
AccelMemory predict_accel_bytes(std::uint64_t primitives, const AccelOptions& options, const DeviceProfile& profile);

/// For a scene: its own tree, one for each shared mesh, and the one over its instances. While the trees are put
/// together their nodes, and after them their blocks, are there twice.
AccelMemory predict_accel_bytes(const FlatScene& flat, const AccelOptions& options, const DeviceProfile& profile);

}  // namespace hemiray
