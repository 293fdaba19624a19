// What kernels are tuned by: one table per device class, overridden by a file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "host/gpu/device.hpp"

namespace hemiray {

/// Every number of the profile, once: FIELD(name, default, least, most, what it is).
#define HR_PROFILE_FIELDS(FIELD)                                                                              \
  FIELD(local_size, 64, 1, 1024, "work-group size of item-a-thing kernels (compiled in)")                     \
  FIELD(chunks, 16, 1, 65536, "work-items of chunked kernels (sort, bounds)")                                 \
  FIELD(chunk_local_size, 1, 1, 1024, "their work-group size")                                                \
  FIELD(sort_groups, 0, 0, 4096, "work-groups that sort in local memory; 0: chunks sort by item")             \
  FIELD(queue_chunks, 16, 1, 65536, "work-items of queue compaction")                                         \
  FIELD(wave_slots, 65536, 64, 1U << 26U, "paths in flight")                                                  \
  FIELD(tail_paths, 16384, 0, 1U << 26U, "so few paths left of a wave walk to their end in one kernel")       \
  FIELD(bvh_width, 8, 2, 8, "children a node: 2, 4 or 8")                                                     \
  FIELD(leaf_lanes, 8, 1, 8, "primitives a block of a leaf: 1, 2, 4 or 8")                                    \
  FIELD(max_leaf, 16, 1, 120, "primitives a leaf, at most 15 blocks")                                         \
  FIELD(explicit_vectors, 1, 0, 1, "1: the lanes of nodes and blocks are vectors of one work-item; 0: loops") \
  FIELD(cluster_chunks, 8, 1, 4096, "work-items that cluster the sorted primitives")                          \
  FIELD(cluster_limit, 32, 2, 64, "clusters a range of the tree may hold before neighbours are merged")       \
  FIELD(cluster_keep, 16, 1, 64, "clusters left then")                                                        \
  FIELD(top_nodes, 16384, 0, 65536, "largest nodes of a quality tree that move to where they cost less")      \
  FIELD(collapse_regions, 256, 2, 65536, "work-items that collapse the binary tree")                          \
  FIELD(rays_per_item, 1, 1, 4096, "rays a work-item of a single-ray query traces")                           \
  FIELD(packet_groups, 4, 1, 8, "vectors of rays a packet has")                                               \
  FIELD(sort_rays, 0, 0, 1U << 26U, "reflected and refracted rays of a wave worth sorting first; 0: never")   \
  FIELD(tree_chunk_kib, 0, 0, 1U << 30U, "largest buffer of a BVH's nodes or blocks [KiB]; 0: the device's own limit")

struct DeviceProfile {
#define HR_MEMBER(name, value, least, most, what) std::uint32_t name = value;
  HR_PROFILE_FIELDS(HR_MEMBER)
#undef HR_MEMBER
  /// The driver caches machine code itself, keyed by the source text, and would compile once more for a binary: then
  /// hemiray's program cache is left out.
  bool has_own_cache = false;
};

/// The table of the device's class: CPUs want few large chunks and waves that stay in the cache, GPUs thousands of
/// items in flight.
DeviceProfile class_profile(const DeviceInfo& device);

/// class_profile(), with what the file named by the environment's HEMIRAY_PROFILE says of this device on top:
///   {"profiles": [{"device": "part of a name", "bvh_width": 4, ...}, ...]}
/// later entries over earlier ones; no "device": any. Throws InputError for a file that cannot be read, a key that is
/// unknown or occurs twice, or a number out of range.
DeviceProfile profile_for(const DeviceInfo& device);

/// The fields as a JSON object, with the device's name: one entry of such a file.
std::string profile_json(const DeviceInfo& device, const DeviceProfile& profile);

}  // namespace hemiray
