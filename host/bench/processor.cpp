#include "host/bench/processor.hpp"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <set>
#include <sstream>

namespace hemiray::bench {

Processor parse_processor(std::string_view cpuinfo) {
  Processor processor;
  std::istringstream lines{std::string(cpuinfo)};
  bool named = false;
  for (std::string line; std::getline(lines, line);) {
    const std::size_t colon = line.find(':');
    if (colon == std::string::npos) continue;
    const std::string key = line.substr(0, line.find_last_not_of(" \t", colon - 1) + 1);
    const std::string value = line.substr(std::min(line.size(), line.find_first_not_of(" \t", colon + 1)));
    if (key == "model name" && !named) {
      processor.name = value;
      named = true;
    } else if (key == "flags" && processor.vector_class.empty()) {
      std::istringstream words(value);
      const std::set<std::string> flags{std::istream_iterator<std::string>(words), {}};
      if (flags.contains("avx512f")) {
        processor.vector_class = "avx512";
      } else if (flags.contains("avx2")) {
        processor.vector_class = "avx2";
      }
    }
  }
  return processor;
}

Processor this_processor() {
  std::ifstream file("/proc/cpuinfo");
  return parse_processor(std::string(std::istreambuf_iterator<char>(file), {}));
}

}  // namespace hemiray::bench
