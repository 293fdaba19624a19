// Three significant digits, with the prefix that fits after rounding.
#include "host/base/numbers.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>

namespace hemiray {
namespace {

constexpr double kTenths = 99.95;  // from here two decimals would be four digits after rounding
constexpr double kHundredths = 9.995;
constexpr double kLargestExact = 9999;
constexpr double kMinute = 60;
constexpr double kHour = 3600;

std::string three_digits(double value) {
  if (value >= kTenths) return fmt::format("{:.0f}", value);
  if (value >= kHundredths) return fmt::format("{:.1f}", value);
  return fmt::format("{:.2f}", value);
}

struct Scaled {
  double value;
  std::size_t prefix;  // how many times it was divided by the base
};

Scaled scale_down(double value, double base, std::size_t largest_prefix) {
  Scaled scaled{value, 0};
  while (std::round(scaled.value) >= base && scaled.prefix < largest_prefix) {
    scaled.value /= base;
    ++scaled.prefix;
  }
  return scaled;
}

constexpr std::array<std::string_view, 7> kDecimalPrefixes{"", "k", "M", "G", "T", "P", "E"};

}  // namespace

std::string format_bytes(std::uint64_t bytes) {
  constexpr std::array<std::string_view, 7> kUnits{"B", "KiB", "MiB", "GiB", "TiB", "PiB", "EiB"};
  const Scaled scaled = scale_down(static_cast<double>(bytes), 1024, kUnits.size() - 1);
  if (scaled.prefix == 0) return fmt::format("{} B", bytes);
  return fmt::format("{} {}", three_digits(scaled.value), kUnits[scaled.prefix]);
}

std::string format_count(std::uint64_t count) {
  if (static_cast<double>(count) <= kLargestExact) return fmt::format("{}", count);
  const Scaled scaled = scale_down(static_cast<double>(count), 1000, kDecimalPrefixes.size() - 1);
  return fmt::format("{} {}", three_digits(scaled.value), kDecimalPrefixes[scaled.prefix]);
}

std::string format_count(std::uint64_t count, std::string_view what) {
  return fmt::format("{} {}{}", format_count(count), what, count == 1 ? "" : "s");
}

std::string format_rate(double per_second, std::string_view unit) {
  if (!std::isfinite(per_second) || per_second < 0) return "-";
  const Scaled scaled = scale_down(per_second, 1000, kDecimalPrefixes.size() - 1);
  return fmt::format("{} {}{}", three_digits(scaled.value), kDecimalPrefixes[scaled.prefix], unit);
}

std::string format_duration(double seconds) {
  if (!std::isfinite(seconds) || seconds < 0) return "-";
  if (seconds == 0) return "0 s";
  if (seconds < 0.9995e-6) return fmt::format("{:.0f} ns", seconds * 1e9);
  if (seconds < 0.9995e-3) return three_digits(seconds * 1e6) + " us";
  if (seconds < 0.9995) return three_digits(seconds * 1e3) + " ms";
  if (seconds < kMinute - 0.05) return three_digits(seconds) + " s";
  const double whole_seconds = std::round(seconds);
  if (whole_seconds < kHour) {
    const double minutes = std::floor(whole_seconds / kMinute);
    return fmt::format("{:.0f} min {:02.0f} s", minutes, whole_seconds - minutes * kMinute);
  }
  const double whole_minutes = std::round(seconds / kMinute);
  const double hours = std::floor(whole_minutes / kMinute);
  return fmt::format("{:.0f} h {:02.0f} min", hours, whole_minutes - hours * kMinute);
}

}  // namespace hemiray
