// Numbers as people read them in tables and messages.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace hemiray {

/// "512 B", "1.50 KiB", "36.0 GiB": binary units, three significant digits.
[[nodiscard]] std::string format_bytes(std::uint64_t bytes);

/// "9999", "12.3 k", "1.20 M": exact up to 9999, then three significant digits with a decimal prefix.
[[nodiscard]] std::string format_count(std::uint64_t count);

/// The same with what is counted: "1 node", "0 nodes", "12.3 k nodes"; `what` takes an s.
[[nodiscard]] std::string format_count(std::uint64_t count, std::string_view what);

/// Events per second with a decimal prefix before the unit: format_rate(12.34e6, "rays/s") is "12.3 Mrays/s".
/// "-" for a rate that is negative, NaN or infinite.
[[nodiscard]] std::string format_rate(double per_second, std::string_view unit);

/// "850 ns", "12.3 ms", "4.56 s", "2 min 05 s", "3 h 07 min" for seconds; "-" where negative, NaN or infinite.
[[nodiscard]] std::string format_duration(double seconds);

}  // namespace hemiray
