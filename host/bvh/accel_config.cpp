#include "host/bvh/accel_config.hpp"

#include <algorithm>
#include <bit>

#include <fmt/format.h>

#include "host/base/error.hpp"

namespace hemiray {
namespace {

constexpr unsigned kMinStack = 128;      // enough for balanced trees of any size
constexpr unsigned kMaxLeafBlocks = 15;  // HR_MAX_LEAF_BLOCKS

void check_power(const char* name, unsigned value, unsigned least) {
  if (!std::has_single_bit(value) || value < least || value > 8) {
    throw InputError(name, fmt::format("{} is not possible; take a power of two from {} to 8", value, least));
  }
}

}  // namespace

std::string AccelConfig::defines() const {
  std::string text = fmt::format(
      "-DHR_BVH_WIDTH={} -DHR_LEAF_LANES={} -DHR_TRIANGLE_WATERTIGHT={} -DHR_TRAVERSAL_STACK={} "
      "-DHR_EXPLICIT_VECTORS={} -DHR_ACCEL={}",
      width, leaf_lanes, watertight ? 1 : 0, stack, explicit_vectors ? 1 : 0, static_cast<int>(kind));
  const auto add_chunks = [&text](const char* array, const ChunkLayout& layout) {
    if (layout.count > 1)
      text += fmt::format(" -DHR_{0}_CHUNKS={1} -DHR_{0}_CHUNK_SHIFT={2}", array, layout.count, layout.shift);
  };
  add_chunks("NODE", node_chunks);
  add_chunks("BLOCK", block_chunks);
  return text;
}

AccelOptions parse_accel(const std::string& name) {
  AccelOptions options;
  if (name == "bvh2") {
    options.width = 2;
  } else if (name == "octree") {
    options.kind = AccelKind::octree;
  } else if (name == "kdtree") {
    options.kind = AccelKind::kdtree;
  } else if (name == "kdtree-median") {
    options.kind = AccelKind::kdtree_median;
  } else if (name != "bvh") {
    throw InputError("tree '" + name + "'", "is not known; take bvh, bvh2, octree, kdtree or kdtree-median");
  }
  return options;
}

AccelOptions complete_options(const AccelOptions& options, const DeviceProfile& profile) {
  AccelOptions o = options;
  if (o.width == 0) o.width = profile.bvh_width;
  if (o.leaf_lanes == 0) o.leaf_lanes = profile.leaf_lanes;
  // A cell lists what touches it: more than a block of it is mostly of others.
  if (o.max_leaf == 0) o.max_leaf = o.kind == AccelKind::bvh ? profile.max_leaf : o.leaf_lanes;
  if (o.explicit_vectors < 0) o.explicit_vectors = static_cast<int>(profile.explicit_vectors);
  check_power("tree width", o.width, 2);
  check_power("leaf lanes", o.leaf_lanes, 1);
  o.max_leaf = std::clamp(o.max_leaf, 1U, kMaxLeafBlocks * o.leaf_lanes);
  return o;
}

AccelConfig config_of(const AccelOptions& complete) {
  AccelConfig config;
  config.width = complete.width;
  config.leaf_lanes = complete.leaf_lanes;
  config.watertight = complete.triangle_test == TriangleTest::watertight;
  config.explicit_vectors = complete.explicit_vectors != 0;
  config.kind = complete.kind;
  return config;
}

unsigned stack_size_for(std::uint32_t needed) { return std::max(kMinStack, std::bit_ceil(needed)); }

}  // namespace hemiray
