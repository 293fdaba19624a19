// How long this process has been running, without the build that ./hemiray may have begun with.
#pragma once

namespace hemiray::app {

/// Seconds since the system started this process (so the loader's time counts too), to 10 ms; 0 where the system does
/// not tell. Where ./hemiray built the program first, since the moment that it was done, which it passes on as
/// HEMIRAY_BUILT_AT [s since the machine's start]: it is the same process.
double seconds_since_process_start();

}  // namespace hemiray::app
