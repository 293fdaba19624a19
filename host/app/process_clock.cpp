#include "host/app/process_clock.hpp"

#include <time.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>

namespace hemiray::app {

namespace {

// [s since the machine's start]; 0 where nothing was built, or it is not told.
double built_at() {
  const char* text = std::getenv("HEMIRAY_BUILT_AT");
  return text != nullptr ? std::strtod(text, nullptr) : 0.0;
}

}  // namespace

double seconds_since_process_start() {
  std::ifstream file("/proc/self/stat");
  std::string text;
  if (!std::getline(file, text)) return 0.0;
  const std::size_t name_end = text.rfind(')');  // the name may hold blanks and brackets
  if (name_end == std::string::npos) return 0.0;
  std::istringstream fields(text.substr(name_end + 1));
  constexpr int kStartTimeField = 20;  // proc(5): field 22, counted from the one after the name
  std::string field;
  for (int i = 0; i < kStartTimeField; i++) fields >> field;
  timespec now{};
  if (!fields || clock_gettime(CLOCK_BOOTTIME, &now) != 0) return 0.0;
  const double start = std::stod(field) / static_cast<double>(sysconf(_SC_CLK_TCK));
  const double end = static_cast<double>(now.tv_sec) + static_cast<double>(now.tv_nsec) * 1e-9;
  const double built = built_at();
  return end - (built > start && built <= end ? built : start);
}

}  // namespace hemiray::app
