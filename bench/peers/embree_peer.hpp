// Embree 3 behind the benchmark's interface. Only built where libembree-dev is installed (HR_HAS_EMBREE).
#pragma once

#include <memory>
#include <string>

#include "host/bench/tracer.hpp"

namespace hemiray::bench {

enum class EmbreeQuality { low, medium, high };

/// rtcIntersect1; rtcIntersect8, 16 and streams of rtcIntersect1M, the last three with the coherent hint.
enum class EmbreeMode { single, eight, sixteen, stream };

struct EmbreeSettings {
  EmbreeQuality quality = EmbreeQuality::medium;  ///< Embree's default
  bool robust = false;                            ///< RTC_SCENE_FLAG_ROBUST
  EmbreeMode mode = EmbreeMode::single;
  unsigned threads = 1;  ///< for building and tracing, >= 1
};

/// Named "embree/QUALITY[/robust]/MODE". Its build time is rtcCommitScene() alone. Denormal numbers are flushed to zero
/// in every thread that traces, as Embree advises. Members throw DeviceError where Embree reports an error.
std::unique_ptr<Tracer> make_embree_peer(const EmbreeSettings& settings);

/// Such as "3.13.5".
std::string embree_version();

}  // namespace hemiray::bench
