// Ctrl-C that lets long work end well.
#pragma once

#include <signal.h>

namespace hemiray {

/// While one lives, the first SIGINT or SIGTERM only sets a flag; the next one acts as if there were no guard (it ends
/// the process). A signal that was ignored before (nohup) stays ignored. The handlers before come back on destruction.
/// The flag is one for the process: use one guard at a time, from one thread. Not copyable.
class InterruptGuard {
 public:
  InterruptGuard();
  ~InterruptGuard();
  InterruptGuard(const InterruptGuard&) = delete;
  InterruptGuard& operator=(const InterruptGuard&) = delete;

  /// Whether a signal came since this guard was made. Callable from any thread.
  [[nodiscard]] bool interrupted() const noexcept;

 private:
  struct sigaction old_interrupt_ {};
  struct sigaction old_terminate_ {};
};

}  // namespace hemiray
