// The clock that everything is timed by.
#pragma once

#include <chrono>

namespace hemiray {

/// Time since some fixed moment [ms]; differences are what counts. Never goes back.
inline double steady_ms() {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace hemiray
