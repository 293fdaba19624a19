// hemiray's own tree and traversal behind the benchmark's interface.
#pragma once

#include <memory>
#include <optional>

#include "host/bench/tracer.hpp"
#include "host/bvh/accel.hpp"
#include "host/gpu/context.hpp"

namespace hemiray::bench {

/// How a tracer asks its rays; packets only where origins are common. double_precision: single rays, in double.
enum class TraceMode { single, packet, double_precision };

struct DeviceTracerSettings {
  TreeBuilder tree = TreeBuilder::quality;
  TriangleTest triangles = TriangleTest::watertight;
  TraceMode mode = TraceMode::single;
  AccelKind kind = AccelKind::bvh;  ///< any other goes by single rays and leaves `tree` out
};

/// The programs and working memory that all tracers of a device build with, made when the first one builds. The context
/// must outlive it.
class DeviceWorkshop {
 public:
  explicit DeviceWorkshop(Context& context) : context_(&context) {}
  [[nodiscard]] Context& context() const { return *context_; }
  AccelBuilder& builder() {
    if (!tools_) tools_.emplace(*context_);
    return tools_->builder;
  }

 private:
  struct Tools {
    explicit Tools(Context& context) : parallel(context), builder(context, parallel, true) {}
    Parallel parallel;
    AccelBuilder builder;
  };
  Context* context_;
  std::optional<Tools> tools_;
};

/// Named "device/TREE/TRIANGLES/MODE", such as "device/quality/watertight/single" or "device/octree/fast/single"; MODE
/// is single, packet or double.
/// Members throw DeviceError where the device fails.
std::unique_ptr<Tracer> make_device_tracer(std::shared_ptr<DeviceWorkshop> workshop,
                                           const DeviceTracerSettings& settings);

}  // namespace hemiray::bench
