#include "host/gpu/profiler.hpp"

#include "host/base/clock.hpp"

namespace hemiray {

Profiler::Profiler() : origin_us_(1e3 * steady_ms()) {}

double Profiler::now_us() const { return 1e3 * steady_ms() - origin_us_; }

std::size_t Profiler::stage_index(const std::string& name) {
  for (std::size_t i = 0; i < stages_.size(); i++) {
    if (stages_[i].name == name) return i;
  }
  stages_.push_back(StageTime{name, 0, 0, 0.0});
  return stages_.size() - 1;
}

void Profiler::record(const std::string& name, const std::string& category, std::uint64_t items,
                      const cl::Event& event) {
  const std::size_t stage = stage_index(name);
  stages_[stage].launches++;
  stages_[stage].items += items;
  pending_.push_back(Pending{stage, category, event});
}

void Profiler::record_host(const std::string& name, const std::string& category, double start_us, double duration_us) {
  if (keep_spans_) spans_.push_back(TraceSpan{name, category, start_us, duration_us});
}

void Profiler::collect() {
  for (const Pending& pending : pending_) {
    const double start = static_cast<double>(pending.event.getProfilingInfo<CL_PROFILING_COMMAND_START>()) * 1e-3;
    const double end = static_cast<double>(pending.event.getProfilingInfo<CL_PROFILING_COMMAND_END>()) * 1e-3;
    stages_[pending.stage].milliseconds += (end - start) * 1e-3;
    if (!keep_spans_) continue;
    if (!has_device_origin_) {
      // The device's clock has its own zero: tie it to the host's by when the first command was queued.
      const double queued = static_cast<double>(pending.event.getProfilingInfo<CL_PROFILING_COMMAND_QUEUED>()) * 1e-3;
      device_to_host_us_ = now_us() - queued;
      has_device_origin_ = true;
    }
    spans_.push_back(TraceSpan{stages_[pending.stage].name, pending.category, start + device_to_host_us_, end - start});
  }
  pending_.clear();
}

}  // namespace hemiray
