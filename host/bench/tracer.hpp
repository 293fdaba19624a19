// What a benchmark needs of anything that traces rays: ours, or a peer.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "host/bench/tree_facts.hpp"
#include "host/bvh/visit_counts.hpp"
#include "host/gpu/profiler.hpp"
#include "host/scene/flat_scene.hpp"
#include "shared/bvh_types.h"

namespace hemiray::bench {

/// Device memory that a build takes at most, the scene's own included [bytes].
struct BuildMemory {
  std::uint64_t peak = 0;
  std::uint64_t predicted = 0;  ///< before it
  unsigned node_buffers = 1, block_buffers = 1;
};

/// Builds a tree over a scene's triangles and answers rays from arrays it has been given, so that the tracing alone can
/// be timed: intersect() and occluded() return when all answers are there, on every thread of its device.
class Tracer {
 public:
  Tracer() = default;
  Tracer(const Tracer&) = delete;
  Tracer& operator=(const Tracer&) = delete;
  Tracer(Tracer&&) = delete;
  Tracer& operator=(Tracer&&) = delete;
  virtual ~Tracer() = default;

  /// Names engine, tree and way of tracing, such as "device/quality/watertight/single"; bars refer to it.
  [[nodiscard]] virtual std::string name() const = 0;
  /// The part of the name that tells which tree it builds, such as "device/quality".
  [[nodiscard]] virtual std::string build_name() const = 0;
  /// Whether it asks rays with a common origin (RaySet::common_origin) in packets.
  [[nodiscard]] virtual bool in_packets() const = 0;

  /// The scene of the builds to come with meshes shared by instances instead of copied, or null: a tracer that can hold
  /// instances builds over it instead, and numbers primitives as in the copied one. It must outlive these builds.
  virtual void offer_instances(const FlatScene* /*instanced*/) {}
  /// Replaces the tree; the scene need not outlive the call. Returns the time from triangles to traversable [ms],
  /// without compilation and without copying the triangles to the tracer.
  virtual double build(const FlatScene& flat) = 0;
  /// Traces through the tree that `other` has built from now on instead of building one; false where it cannot.
  virtual bool share_build(const Tracer& other) = 0;
  /// The last build's stages, the tree's figures and the memory, where the tracer knows them.
  [[nodiscard]] virtual std::vector<StageTime> build_stages() const { return {}; }
  [[nodiscard]] virtual std::optional<TreeFacts> facts() const { return std::nullopt; }
  [[nodiscard]] virtual std::optional<BuildMemory> build_memory() const { return std::nullopt; }

  /// Copies the rays; a multiple of 64. To be called after build() or share_build().
  virtual void load_rays(std::span<const shared::QueryRay> rays) = 0;
  /// Closest hits of the loaded rays.
  virtual void intersect() = 0;
  /// Whether the loaded rays meet anything.
  virtual void occluded() = 0;
  /// What the last intersect() found, in the rays' order.
  [[nodiscard]] virtual std::vector<shared::QueryHit> hits() = 0;
  /// What the last occluded() found: 1 or 0 a ray.
  [[nodiscard]] virtual std::vector<std::uint32_t> occlusions() = 0;
  /// How many nodes and blocks a loaded ray comes to, where the tracer can count them.
  [[nodiscard]] virtual std::optional<VisitCounts> visits(bool /*any_hit*/) { return std::nullopt; }
};

}  // namespace hemiray::bench
