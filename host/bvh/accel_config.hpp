// How a tree is made and laid out: what a user chooses, and what is compiled into the kernels that read it.
#pragma once

#include <cstdint>
#include <string>

#include "host/gpu/device_profile.hpp"

namespace hemiray {

/// fast: the radix tree over Morton codes (Karras 2012). quality: clusters merged along it (H-PLOC, 2024).
enum class TreeBuilder { fast, quality };

/// watertight: no ray slips between triangles that share an edge, boxes included. fast: Möller–Trumbore.
enum class TriangleTest { watertight, fast };

/// bvh: boxes around primitives. Trees of cells, which list every primitive that touches them: octree and k-d tree cut
/// where Morton codes do, the median k-d tree halves the primitives. All give the same hits; they are there to compare.
enum class AccelKind { bvh, octree, kdtree, kdtree_median };

struct AccelOptions {
  TreeBuilder builder = TreeBuilder::quality;
  TriangleTest triangle_test = TriangleTest::watertight;
  unsigned morton_bits = 0;   ///< of the codes, a multiple of 3 up to 63 less the bits of an index; 0: by the builder
  unsigned width = 0;         ///< children a node: 2, 4 or 8; 0: the device profile's
  unsigned leaf_lanes = 0;    ///< primitives a block: 1, 2, 4 or 8; 0: the device profile's
  unsigned max_leaf = 0;      ///< primitives a leaf, at most 15 blocks; 0: the device profile's, in cells a block
  int explicit_vectors = -1;  ///< 1: lanes are vectors, 0: loops; -1: the device profile's choice
  AccelKind kind = AccelKind::bvh;
};

/// How an array lies in buffers, of 2^shift elements each but the last (kernels/lib/tree_chunks.h).
struct ChunkLayout {
  unsigned count = 1;
  unsigned shift = 31;
};

/// What the kernels of kernels/lib/accel_layout.h are compiled for.
struct AccelConfig {
  unsigned width = 8;
  unsigned leaf_lanes = 8;
  unsigned stack = 128;
  bool watertight = true;
  bool explicit_vectors = true;
  AccelKind kind = AccelKind::bvh;
  ChunkLayout node_chunks, block_chunks;

  /// "-DHR_BVH_WIDTH=8 ...", for ProgramOptions.
  [[nodiscard]] std::string defines() const;
  /// Packets walk the bvh's nodes and blocks, in vectors (HR_PACKETS of kernels/lib/packet.h).
  [[nodiscard]] bool has_packets() const { return explicit_vectors && kind == AccelKind::bvh && leaf_lanes > 1; }
  [[nodiscard]] std::size_t node_words() const { return std::size_t{8} * width; }
  [[nodiscard]] std::size_t block_words() const { return std::size_t{10} * leaf_lanes; }
};

/// The options for a tree's name: bvh, bvh2 (two children a node), octree, kdtree, kdtree-median; the rest is left to
/// the profile. Throws InputError for any other name.
AccelOptions parse_accel(const std::string& name);

/// The options completed from the device's profile. Throws InputError if they cannot be had together.
AccelOptions complete_options(const AccelOptions& options, const DeviceProfile& profile);

/// What completed options are compiled to, before a build finds its stack and chunks.
AccelConfig config_of(const AccelOptions& complete);

/// Entries for the traversal's stack, from what the tree needs: few sizes, so that few programs are compiled.
unsigned stack_size_for(std::uint32_t needed);

}  // namespace hemiray
