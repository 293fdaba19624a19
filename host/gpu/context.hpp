// One device in use: OpenCL context, in-order queue, profile, memory account and timings.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>

#include "host/gpu/device.hpp"
#include "host/gpu/device_profile.hpp"
#include "host/gpu/host_memory.hpp"
#include "host/gpu/profiler.hpp"

namespace hemiray {

struct BuiltProgram;

/// Everything that runs on the device takes a Context&; there is no global one. Not copyable, not thread-safe.
class Context {
 public:
  /// Throws DeviceError if the device cannot be opened.
  explicit Context(const DeviceInfo& device) : Context(device, profile_for(device)) {}
  /// The same with another profile than the device's own, to try it out.
  Context(const DeviceInfo& device, const DeviceProfile& profile);
  Context(const Context&) = delete;
  Context& operator=(const Context&) = delete;
  Context(Context&&) = delete;
  Context& operator=(Context&&) = delete;
  ~Context() = default;

  [[nodiscard]] const DeviceInfo& device() const { return device_; }
  [[nodiscard]] const DeviceProfile& profile() const { return profile_; }
  [[nodiscard]] cl::Context& handle() { return context_; }
  [[nodiscard]] cl::CommandQueue& queue() { return queue_; }
  [[nodiscard]] Profiler& profiler() { return profiler_; }

  /// Waits for all commands and reads their times. A failure of a command shows here as DeviceError.
  void finish();

  /// Of what Program has built in this context, the entry of a key; empty at first.
  [[nodiscard]] std::shared_ptr<BuiltProgram>& built_program(const std::string& key) { return programs_[key]; }
  /// What building programs and their kernels' first launches took so far.
  [[nodiscard]] double compile_ms() const { return build_ms_ + launch_compile_ms_; }
  void account_build(double milliseconds) { build_ms_ += milliseconds; }

  /// Account of first launches, kept by launch(): some drivers compile a kernel only then.
  void account_first_launch(double milliseconds);
  [[nodiscard]] double launch_compile_ms() const { return launch_compile_ms_; }
  [[nodiscard]] std::size_t kernels_compiled() const { return kernels_compiled_; }

  /// Memory account, kept by Buffer. Throws DeviceError if `bytes` more do not fit the device ("needs ..., has ...").
  void account_allocation(std::uint64_t bytes, const std::string& name);
  void account_release(std::uint64_t bytes) noexcept { allocated_bytes_ -= bytes; }
  [[nodiscard]] std::uint64_t allocated_bytes() const { return allocated_bytes_; }
  [[nodiscard]] std::uint64_t peak_bytes() const { return peak_bytes_; }
  /// The peak of what is to come.
  void restart_peak() { peak_bytes_ = allocated_bytes_; }

  /// Memory for a large buffer on a CPU device, empty for any other: freed before, if some fits, so that building again
  /// finds its pages there (IdleHostMemory says how much waits at most).
  HostMemory take_host_memory(std::uint64_t bytes);
  void keep_host_memory(HostMemory memory) noexcept;
  [[nodiscard]] std::uint64_t idle_bytes() const { return idle_.bytes(); }

 private:
  DeviceInfo device_;
  DeviceProfile profile_;
  cl::Context context_;
  cl::CommandQueue queue_;
  Profiler profiler_;
  std::uint64_t allocated_bytes_ = 0;
  std::uint64_t peak_bytes_ = 0;
  IdleHostMemory idle_;
  std::map<std::string, std::shared_ptr<BuiltProgram>> programs_;
  double build_ms_ = 0.0;
  double launch_compile_ms_ = 0.0;
  std::size_t kernels_compiled_ = 0;
};

}  // namespace hemiray
