#include "host/gpu/context.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "host/base/numbers.hpp"
#include "host/gpu/cl_error.hpp"

namespace hemiray {

Context::Context(const DeviceInfo& device, const DeviceProfile& profile) : device_(device), profile_(profile) {
  cl_guard("opening device " + device.name, [this] {
    context_ = cl::Context(device_.handle);
    queue_ = cl::CommandQueue(context_, device_.handle, CL_QUEUE_PROFILING_ENABLE);
  });
}

void Context::finish() {
  cl_guard("running kernels on " + device_.name, [this] {
    queue_.finish();
    profiler_.collect();
  });
}

void Context::account_first_launch(double milliseconds) {
  // A compiled kernel is loaded in about 1 ms; compiling takes 50 ms and more.
  constexpr double kCompileThresholdMs = 20.0;
  launch_compile_ms_ += milliseconds;
  if (milliseconds > kCompileThresholdMs) kernels_compiled_++;
}

void Context::account_allocation(std::uint64_t bytes, const std::string& name) {
  if (bytes > device_.max_allocation_bytes) {
    throw DeviceError(fmt::format("device memory: {} needs {} in one piece, {} allows {}", name, format_bytes(bytes),
                                  device_.name, format_bytes(device_.max_allocation_bytes)));
  }
  if (allocated_bytes_ + bytes > device_.global_bytes) {
    throw DeviceError(fmt::format("device memory: {} needs {} beside the {} in use, {} has {}", name,
                                  format_bytes(bytes), format_bytes(allocated_bytes_), device_.name,
                                  format_bytes(device_.global_bytes)));
  }
  allocated_bytes_ += bytes;
  peak_bytes_ = std::max(peak_bytes_, allocated_bytes_);
}

HostMemory Context::take_host_memory(std::uint64_t bytes) {
  if (device_.kind != DeviceKind::cpu || bytes < kHugeMemoryBytes) return {};
  return idle_.take(bytes);
}

void Context::keep_host_memory(HostMemory memory) noexcept {
  if (memory.memory) idle_.keep(std::move(memory));
}

}  // namespace hemiray
