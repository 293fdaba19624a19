// Times of all device commands, by name.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "host/gpu/opencl.hpp"

namespace hemiray {

/// Totals of one kind of command.
struct StageTime {
  std::string name;
  std::uint64_t launches = 0;
  std::uint64_t items = 0;
  double milliseconds = 0.0;  ///< on the device
};

/// One command for the trace; microseconds since the profiler was made.
struct TraceSpan {
  std::string name;
  std::string category;
  double start_us = 0.0;
  double duration_us = 0.0;
};

/// Collects the events of a profiling queue. Events are read and released in batches.
class Profiler {
 public:
  Profiler();
  void record(const std::string& name, const std::string& category, std::uint64_t items, const cl::Event& event);
  /// A span on the host: compilation, loading. Times are from now_us().
  void record_host(const std::string& name, const std::string& category, double start_us, double duration_us);
  /// Reads all finished events; call after the queue is drained.
  void collect();
  [[nodiscard]] const std::vector<StageTime>& stages() const { return stages_; }
  [[nodiscard]] const std::vector<TraceSpan>& spans() const { return spans_; }
  [[nodiscard]] bool has_pending() const { return pending_.size() >= kBatch; }
  [[nodiscard]] double now_us() const;
  void keep_spans(bool keep) { keep_spans_ = keep; }

 private:
  struct Pending {
    std::size_t stage;
    std::string category;
    cl::Event event;
  };
  static constexpr std::size_t kBatch = 4096;  ///< events held before they are read

  std::size_t stage_index(const std::string& name);

  std::vector<StageTime> stages_;
  std::vector<TraceSpan> spans_;
  std::vector<Pending> pending_;
  double origin_us_ = 0.0;
  bool keep_spans_ = false;
  bool has_device_origin_ = false;
  double device_to_host_us_ = 0.0;
};

}  // namespace hemiray
