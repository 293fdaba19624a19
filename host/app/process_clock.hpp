// How long this process has been running.
#pragma once

namespace hemiray::app {

/// Seconds since the system started this process (so the loader's time counts too), to 10 ms; 0 where the system does
/// not tell.
double seconds_since_process_start();

}  // namespace hemiray::app
