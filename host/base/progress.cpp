// The line is padded with blanks over the one before it, so dumb terminals show it as well.
#include "host/base/progress.hpp"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <utility>
#include <vector>

#include "host/base/numbers.hpp"

namespace hemiray {
namespace {

constexpr std::chrono::milliseconds kQuietTime{1000};
constexpr std::chrono::milliseconds kInterval{100};
constexpr std::size_t kDefaultColumns = 80;
constexpr std::size_t kMinBar = 6;  // characters inside the brackets; less says nothing
constexpr std::size_t kMaxBar = 40;
constexpr std::size_t kMaxColumns = 400;

std::size_t terminal_columns() {
  if (const char* text = std::getenv("COLUMNS"); text != nullptr) {
    std::size_t columns = 0;
    const char* end = text + std::strlen(text);
    const auto [stop, error] = std::from_chars(text, end, columns);
    if (error == std::errc() && stop == end && columns > 0) return std::min(columns, kMaxColumns);
  }
  winsize size{};
  if (ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0) {
    return std::min<std::size_t>(size.ws_col, kMaxColumns);
  }
  return kDefaultColumns;
}

// A terminal that went away is no reason to stop the work.
void write_to_stderr(const std::string& text) {
  const ssize_t ignored = write(STDERR_FILENO, text.data(), text.size());
  static_cast<void>(ignored);
}

// Whole seconds: decimals that change ten times a second only flicker.
std::string clock_text(double seconds) {
  return seconds < 60 ? fmt::format("{:.0f} s", seconds) : format_duration(seconds);
}

std::string bar(double fraction, std::size_t inside) {
  const auto full = static_cast<std::size_t>(fraction * static_cast<double>(inside));
  return "[" + std::string(full, '#') + std::string(inside - full, '.') + "]";
}

}  // namespace

std::string progress_line(const std::string& label, const ProgressState& state, std::size_t columns) {
  const double fraction = state.fraction > 0 ? std::min(state.fraction, 1.0) : 0.0;
  const std::size_t width = columns > 0 ? columns - 1 : 0;
  const std::string percent = fmt::format("{:3.0f} %", std::floor(fraction * 100));
  const std::string rate = state.rays_per_second > 0 ? "  " + format_rate(state.rays_per_second, "rays/s") : "";
  const std::string elapsed = "  " + clock_text(std::floor(state.elapsed_s));
  const std::string left =
      fraction > 0 ? "  " + clock_text(std::ceil(state.elapsed_s * (1 - fraction) / fraction)) + " left" : "";

  // From everything to nearly nothing; the first that leaves room for a bar, or fits without one, is taken.
  const std::string before = label + " ";
  const std::vector<std::string> tails{rate + elapsed + left, rate + left, left};
  for (const std::string& tail : tails) {
    const std::size_t fixed = before.size() + 2 + 1 + percent.size() + tail.size();
    if (fixed + kMinBar <= width) {
      return before + bar(fraction, std::min(width - fixed, kMaxBar)) + " " + percent + tail;
    }
  }
  for (const std::string& line : {before + percent + left, before + percent, percent}) {
    if (line.size() <= width) return line;
  }
  return "";
}

Progress::Progress(std::string label, bool enabled)
    : label_(std::move(label)),
      active_(enabled && isatty(STDERR_FILENO) == 1),
      start_(Clock::now()),
      last_draw_(start_) {}

void Progress::update(double fraction, double rays_per_second) {
  if (!active_) return;
  const Clock::time_point now = Clock::now();
  if (now - start_ < kQuietTime || now - last_draw_ < kInterval) return;
  last_draw_ = now;
  const double elapsed_s = std::chrono::duration<double>(now - start_).count();
  const std::size_t columns = terminal_columns();
  const std::string line = progress_line(label_, {fraction, rays_per_second, elapsed_s}, columns);
  const std::size_t old_length = std::min(drawn_, columns - 1);  // the terminal may have narrowed
  write_to_stderr("\r" + line + std::string(old_length - std::min(old_length, line.size()), ' '));
  drawn_ = line.size();
}

void Progress::clear() {
  if (drawn_ > 0) write_to_stderr("\r" + std::string(std::min(drawn_, terminal_columns() - 1), ' ') + "\r");
  drawn_ = 0;
}

void Progress::finish() {
  clear();
  active_ = false;
}

}  // namespace hemiray
