// The acceleration structure: built wholly by kernels on the device, asked by arrays of rays or by other effects'
// kernels.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "host/bvh/accel_config.hpp"
#include "host/bvh/tree_chunks.hpp"
#include "host/gpu/buffer.hpp"
#include "host/gpu/parallel.hpp"
#include "host/gpu/program.hpp"
#include "host/scene/device_scene.hpp"
#include "shared/bvh_types.h"
#include "shared/params.h"

namespace hemiray {

/// What the build found and made.
struct AccelStatistics {
  std::uint32_t primitives = 0;  ///< in the trees, those of a shared mesh once
  std::uint32_t instances = 0;   ///< placed in the tree over them
  std::uint32_t non_finite = 0;  ///< dropped: NaN or infinite
  std::uint32_t degenerate = 0;  ///< dropped: no area or radius
  unsigned morton_bits = 0;
  std::uint32_t nodes = 0;        ///< of `width` children, all trees together
  std::uint32_t blocks = 0;       ///< of the leaves
  std::uint32_t stack_depth = 0;  ///< most entries a traversal's stack can hold
  std::uint32_t references = 0;   ///< of primitives in leaves: more than primitives in trees of cells
  std::uint32_t depth = 0;        ///< of trees of cells: cuts above the deepest leaf
  shared::float4 lo{}, hi{};      ///< bounds [m]; lo > hi if there is no primitive
  double build_ms = 0.0;          ///< wall time from triangles to what can be traced, without compilation
};

/// The programs that build trees, compiled once a context, and the memory they work in.
class AccelBuilder {
 public:
  /// `keep_scratch`: the working memory stays for the next build (rebuilding, measuring); else each build frees it.
  AccelBuilder(Context& context, Parallel& parallel, bool keep_scratch = false);

  /// All programs so far: for their statistics.
  [[nodiscard]] std::vector<const Program*> programs() const;
  /// Of the working memory that it holds at the moment.
  [[nodiscard]] std::uint64_t scratch_bytes() const;

 private:
  friend class Accel;

  struct Scratch {
    Buffer<shared::Box> boxes;
    Buffer<std::uint64_t> keys, keys_other;
    Buffer<shared::BinaryNode> binary;
    Buffer<float> arenas, join_arena, draft;
    Buffer<shared::TopNode> top;
    Buffer<shared::int2> pending;
    Buffer<shared::uint2> node_ranges;
    Buffer<std::uint32_t> pending_count, totals;
    Buffer<std::int32_t> root;
  };

  /// Makes sure that the buffer has at least `size` elements.
  template <typename T>
  Buffer<T>& ensure(Buffer<T>& buffer, const char* name, std::size_t size) {
    if (buffer.name().empty() || buffer.size() < size) {
      buffer = Buffer<T>();
      buffer = Buffer<T>(*context_, name, size);
    }
    return buffer;
  }
  template <typename T>
  void release(Buffer<T>& buffer) {
    if (!keep_scratch_) buffer = Buffer<T>();
  }
  Program& top_program();
  Program& layout_program(const AccelConfig& config);
  Program& cell_program(const AccelConfig& config);      // host/bvh/cell_trees.cpp
  Program& instance_program(const AccelConfig& config);  // host/bvh/accel_instances.cpp
  Kernel& copy_words();

  Context* context_;
  Parallel* parallel_;
  bool keep_scratch_;
  Program program_;
  std::optional<Program> top_program_;              ///< of trees large enough that moving nodes pays
  std::optional<Program> copy_program_;             ///< of trees that are joined, or lie in chunks
  std::map<std::string, Program> layout_programs_;  ///< by the configuration's defines
  std::map<std::string, Program> cell_programs_, instance_programs_;
  Scratch scratch_;
};

/// A BVH, or a tree of cells, over a scene's triangles, spheres and shapes, wholly built on the device. Where the scene
/// has instances, each mesh they share has a tree of its own behind the world's, and the last tree is over the
/// instances. The DeviceScene and the builder must outlive it. The same scene and options give the same bytes.
class Accel {
 public:
  /// Bounds, Morton codes, radix sort, binary tree, collapse, leaf blocks. Throws DeviceError; InputError for options
  /// that cannot be had together, or a tree of cells over instances.
  Accel(AccelBuilder& builder, const DeviceScene& scene, const AccelOptions& options = {});

  /// New boxes and leaf geometry after the scene's vertices moved; the tree's shape stays, so a query answers as after
  /// a rebuild, only slower, and statistics() keeps the old bounds; a tree of cells is rebuilt. A primitive that was
  /// dropped stays out; one that becomes NaN is met by no ray.
  void refit(const DeviceScene& scene);

  [[nodiscard]] const AccelStatistics& statistics() const { return statistics_; }
  [[nodiscard]] const AccelConfig& config() const { return config_; }
  /// accel_nodes and accel_blocks, and tree_roots for a scene with instances, for kernels that trace.
  [[nodiscard]] Arguments tree_arguments() const;
  /// Options for a program whose kernels trace through this tree.
  [[nodiscard]] ProgramOptions program_options(std::uint32_t features, bool strict,
                                               bool double_precision = false) const;
  [[nodiscard]] const TreeChunks& nodes() const { return nodes_; }
  [[nodiscard]] const TreeChunks& blocks() const { return blocks_; }

 private:
  // A tree whose nodes and blocks wait to be joined with the others'; then only what a refit needs.
  struct Tree {
    TreeInput input;
    Buffer<shared::CollapseRegion> regions;
    std::uint32_t region_count = 0;  // 0: nothing is in it
    std::uint32_t first_node = 0;    // the root
    AccelStatistics statistics;
    TreeChunks nodes, blocks;
  };

  /// What programs that lay out the tree are compiled for: no stack.
  [[nodiscard]] AccelConfig layout_config() const;
  void build_tree(const DeviceScene& scene, const AccelOptions& options, const TreeInput& input);
  void bound_primitives(const DeviceScene& scene);
  void ensure_boxes(std::uint32_t count);
  void take_bounds(const Buffer<shared::BoundsPartial>& partials);
  void sort_primitives(const AccelOptions& options);
  void cluster(const AccelOptions& options);
  void improve_top();
  void collapse(const DeviceScene& scene, const AccelOptions& options);
  void make_empty();
  // These say in config_ how they are dealt out to chunks.
  void make_nodes(std::uint64_t count);
  void make_blocks(std::uint64_t count);
  void repeat_blocks();
  void refit_tree(const DeviceScene& scene, const TreeInput& input, const Buffer<shared::CollapseRegion>& regions,
                  std::uint32_t region_count);
  void build_cells(const DeviceScene& scene, const AccelOptions& options);  // host/bvh/cell_trees.cpp

  // host/bvh/accel_instances.cpp
  void build_with_instances(const DeviceScene& scene, const AccelOptions& options);
  void build_instance_tree(const DeviceScene& scene, const AccelOptions& options);
  void bound_instances(const DeviceScene& scene);
  void bound_mesh(std::uint32_t root, std::uint32_t mesh);
  void keep_tree();
  void join_trees();
  void refit_with_instances(const DeviceScene& scene);

  AccelBuilder* builder_;
  AccelStatistics statistics_;
  AccelConfig config_;
  AccelOptions options_;
  shared::float4 centroid_lo_{}, centroid_hi_{};
  unsigned index_bits_ = 1;
  std::uint32_t region_count_ = 0;
  Buffer<shared::CollapseRegion> regions_;
  TreeChunks nodes_, blocks_;

  TreeInput input_;                                 // of the tree being built
  bool of_instances_ = false;                       // it is the tree over instances
  std::uint32_t first_node_ = 0, first_block_ = 0;  // its place behind those built before
  std::vector<Tree> trees_;                         // with instances: the world's, the shared meshes', the instances'
  Buffer<shared::Box> mesh_boxes_;                  // of the shared meshes, in object space
  Buffer<std::int32_t> tree_roots_;                 // of the last of these trees, then of the shared meshes'
};

}  // namespace hemiray
