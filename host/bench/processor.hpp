// The processor a benchmark runs on, as /proc/cpuinfo tells it.
#pragma once

#include <string>
#include <string_view>

namespace hemiray::bench {

struct Processor {
  std::string name = "unknown processor";
  std::string vector_class;  ///< "avx512", "avx2", or "" for any other
};

/// From the text of /proc/cpuinfo.
Processor parse_processor(std::string_view cpuinfo);

/// This machine's.
Processor this_processor();

}  // namespace hemiray::bench
