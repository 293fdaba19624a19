// The handler touches a lock-free atomic and calls signal() and raise() only, all of them async-signal-safe.
#include "host/base/interrupt.hpp"

#include <atomic>

namespace hemiray {
namespace {

// A signal handler reaches nothing but static storage.
std::atomic<bool> signal_came{false};
static_assert(std::atomic<bool>::is_always_lock_free);

extern "C" void hemiray_on_signal(int number) {
  if (!signal_came.exchange(true)) return;
  signal(number, SIG_DFL);
  raise(number);  // delivered when this handler returns
}

void install(int number, struct sigaction& old) {
  sigaction(number, nullptr, &old);
  if (old.sa_handler == SIG_IGN) return;
  struct sigaction action {};
  action.sa_handler = hemiray_on_signal;
  action.sa_flags = SA_RESTART;  // no EINTR for code that does not expect it
  sigemptyset(&action.sa_mask);
  sigaction(number, &action, nullptr);
}

}  // namespace

InterruptGuard::InterruptGuard() {
  signal_came = false;
  install(SIGINT, old_interrupt_);
  install(SIGTERM, old_terminate_);
}

InterruptGuard::~InterruptGuard() {
  sigaction(SIGINT, &old_interrupt_, nullptr);
  sigaction(SIGTERM, &old_terminate_, nullptr);
}

bool InterruptGuard::interrupted() const noexcept { return signal_came; }

}  // namespace hemiray
