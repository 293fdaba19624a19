// The progress bar on the terminal.
#pragma once

#include <chrono>
#include <cstddef>
#include <string>

namespace hemiray {

/// What a progress line shows.
struct ProgressState {
  double fraction = 0;         ///< done, 0 to 1
  double rays_per_second = 0;  ///< left out where 0
  double elapsed_s = 0;
};

/// The line for a terminal of `columns` characters, at most columns - 1 long (the last column would wrap). As the
/// terminal narrows it loses the elapsed time, the rate, the bar, the label; the last thing left is the percentage.
[[nodiscard]] std::string progress_line(const std::string& label, const ProgressState& state, std::size_t columns);

/// Draws one line on stderr, in place, at most 10 times a second, and clears it at the end. Silent unless `enabled` and
/// stderr is a terminal, and for work that takes less than a second. No colour, no escape sequences.
/// The width is $COLUMNS, else the terminal's own, else 80. For one thread.
class Progress {
 public:
  Progress(std::string label, bool enabled);
  ~Progress() { finish(); }
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// fraction: 0 to 1 (clamped; NaN counts as 0); rays_per_second: 0 where there is no rate to show.
  void update(double fraction, double rays_per_second);
  /// Clears the line. Later updates draw nothing.
  void finish();
  /// Wipes the line, for other output to take its place; update() draws it again.
  void clear();

 private:
  using Clock = std::chrono::steady_clock;
  std::string label_;
  bool active_;
  Clock::time_point start_;
  Clock::time_point last_draw_;
  std::size_t drawn_ = 0;  // characters on the line now
};

}  // namespace hemiray
