#include "host/bench/device_tracer.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "host/bvh/accel_memory.hpp"
#include "host/bvh/ray_queries.hpp"
#include "host/scene/features.hpp"

namespace hemiray::bench {
namespace {

std::uint32_t features_for(const FlatScene& flat) {
  return triangle_features(flat) | (flat.instances.empty() ? 0U : HR_FEATURE_INSTANCES);
}

// The triangles on the device and the tree over them.
struct DeviceBuild {
  DeviceBuild(DeviceWorkshop& workshop, const FlatScene& flat, const AccelOptions& options)
      : scene(workshop.context(), flat, features_for(flat)), accel(workshop.builder(), scene, options) {}
  DeviceScene scene;
  Accel accel;
};

// What the profiler has counted between two moments.
std::vector<StageTime> difference(const std::vector<StageTime>& before, std::vector<StageTime> after) {
  for (StageTime& stage : after) {
    const auto same = [&](const StageTime& other) { return other.name == stage.name; };
    const auto earlier = std::find_if(before.begin(), before.end(), same);
    if (earlier == before.end()) continue;
    stage.launches -= earlier->launches;
    stage.items -= earlier->items;
    stage.milliseconds -= earlier->milliseconds;
  }
  std::erase_if(after, [](const StageTime& stage) { return stage.launches == 0; });
  return after;
}

class DeviceTracer final : public Tracer {
 public:
  DeviceTracer(std::shared_ptr<DeviceWorkshop> workshop, const DeviceTracerSettings& settings)
      : workshop_(std::move(workshop)), settings_(settings) {}

  std::string name() const override {
    return build_name() + (settings_.triangles == TriangleTest::watertight ? "/watertight" : "/fast") +
           (in_packets()  ? "/packet"
            : in_double() ? "/double"
                          : "/single");
  }
  std::string build_name() const override {
    switch (settings_.kind) {
      case AccelKind::octree:
        return "device/octree";
      case AccelKind::kdtree:
        return "device/kdtree";
      case AccelKind::kdtree_median:
        return "device/kdtree-median";
      case AccelKind::bvh:
        break;
    }
    return settings_.tree == TreeBuilder::quality ? "device/quality" : "device/fast";
  }
  bool in_packets() const override { return settings_.mode == TraceMode::packet; }

  void offer_instances(const FlatScene* instanced) override { instanced_ = instanced; }
  double build(const FlatScene& flat) override {
    queries_.reset();  // before the new one takes its memory
    build_.reset();
    context().finish();
    const std::vector<StageTime> before = context().profiler().stages();
    AccelOptions options;
    options.builder = settings_.tree;
    options.triangle_test = settings_.triangles;
    options.kind = settings_.kind;
    const bool has_instances = instanced_ != nullptr && settings_.kind == AccelKind::bvh;
    const FlatScene& given = has_instances ? *instanced_ : flat;
    const std::uint64_t held = workshop_->builder().scratch_bytes(), others = context().allocated_bytes() - held;
    context().restart_peak();
    build_ = std::make_shared<DeviceBuild>(*workshop_, given, options);
    context().finish();
    memory_.peak = context().peak_bytes() - others;
    memory_.predicted = predict_scene_bytes(given, features_for(given)) +
                        peak_with_kept_scratch(predict_accel_bytes(given, options, context().profile()), held);
    memory_.node_buffers = build_->accel.config().node_chunks.count;
    memory_.block_buffers = build_->accel.config().block_chunks.count;
    stages_ = difference(before, context().profiler().stages());
    return build_->accel.statistics().build_ms;
  }
  bool share_build(const Tracer& other) override {
    const auto* tracer = dynamic_cast<const DeviceTracer*>(&other);
    // The triangle tests lay their leaf blocks out differently.
    if (tracer == nullptr || !tracer->build_ || tracer->build_name() != build_name() ||
        tracer->settings_.triangles != settings_.triangles) {
      return false;
    }
    queries_.reset();
    build_ = tracer->build_;
    return true;
  }
  std::vector<StageTime> build_stages() const override { return stages_; }
  std::optional<BuildMemory> build_memory() const override {
    if (memory_.peak == 0) return std::nullopt;  // it shares another's build
    return memory_;
  }
  std::optional<TreeFacts> facts() const override {
    if (!build_ || build_->scene.instance_count() > 0) return std::nullopt;  // facts are of a single tree
    const Accel& accel = build_->accel;
    const AccelStatistics& made = accel.statistics();
    if (settings_.kind != AccelKind::bvh) return cell_tree_facts();
    const std::vector<float> nodes = accel.nodes().read(0, made.nodes * accel.config().node_words());
    return tree_facts(nodes, accel.config().width, made.primitives, made.blocks, accel.config().leaf_lanes);
  }

  void load_rays(std::span<const shared::QueryRay> rays) override {
    if (rays.size() % 64 != 0) throw std::logic_error("rays come in multiples of 64");
    if (!build_) throw std::logic_error("rays before a build");
    if (!queries_)
      queries_ = std::make_unique<RayQueries>(context(), build_->scene, build_->accel, false,
                                              in_packets() ? RayGrouping::packets : RayGrouping::single, in_double());
    if (rays_.size() != rays.size()) {
      rays_ = {}, hits_ = {}, occlusions_ = {};
      rays_ = Buffer<shared::QueryRay>(context(), "rays", rays.size());
      hits_ = Buffer<shared::QueryHit>(context(), "hits", rays.size());
      occlusions_ = Buffer<std::uint32_t>(context(), "occluded", rays.size());
    }
    rays_.write(rays);
  }
  void intersect() override {
    queries().intersect(rays_, hits_, count());
    context().finish();
  }
  void occluded() override {
    queries().occluded(rays_, occlusions_, count());
    context().finish();
  }
  std::vector<shared::QueryHit> hits() override { return hits_.read(); }
  std::vector<std::uint32_t> occlusions() override { return occlusions_.read(); }
  std::optional<VisitCounts> visits(bool any_hit) override {
    if (in_packets() || settings_.kind != AccelKind::bvh) return std::nullopt;
    return count_visits(context(), build_->scene, build_->accel, rays_, count(), any_hit);
  }

 private:
  Context& context() { return workshop_->context(); }
  [[nodiscard]] bool in_double() const { return settings_.mode == TraceMode::double_precision; }
  // What its build tells: these nodes are none of tree_facts()'s.
  [[nodiscard]] TreeFacts cell_tree_facts() const {
    const Accel& accel = build_->accel;
    const AccelStatistics& made = accel.statistics();
    TreeFacts facts;
    facts.depth = static_cast<int>(made.depth);
    facts.nodes = made.nodes;
    facts.blocks = made.blocks;
    facts.bytes = accel.nodes().bytes() + accel.blocks().bytes();
    const double lanes = static_cast<double>(made.blocks) * accel.config().leaf_lanes;
    if (lanes > 0) facts.block_fill = made.references / lanes;
    if (made.primitives > 0) facts.references = static_cast<double>(made.references) / made.primitives;
    return facts;
  }
  RayQueries& queries() {
    if (!queries_) throw std::logic_error("a question before its rays");
    return *queries_;
  }
  [[nodiscard]] std::uint32_t count() const { return static_cast<std::uint32_t>(rays_.size()); }

  std::shared_ptr<DeviceWorkshop> workshop_;
  DeviceTracerSettings settings_;
  const FlatScene* instanced_ = nullptr;
  std::shared_ptr<DeviceBuild> build_;
  std::unique_ptr<RayQueries> queries_;
  std::vector<StageTime> stages_;
  BuildMemory memory_;
  Buffer<shared::QueryRay> rays_;
  Buffer<shared::QueryHit> hits_;
  Buffer<std::uint32_t> occlusions_;
};

}  // namespace

std::unique_ptr<Tracer> make_device_tracer(std::shared_ptr<DeviceWorkshop> workshop,
                                           const DeviceTracerSettings& settings) {
  return std::make_unique<DeviceTracer>(std::move(workshop), settings);
}

}  // namespace hemiray::bench
