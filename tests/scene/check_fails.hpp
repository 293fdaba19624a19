// How tests of hostile files look at an error.
#pragma once

#include <catch2/catch.hpp>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "host/base/error.hpp"

namespace hemiray::test {

/// A FileResolver for readers that must not need any other file.
inline std::optional<std::vector<std::uint8_t>> no_files(const std::string&) { return std::nullopt; }

inline std::vector<std::uint8_t> bytes_of(const std::string& text) { return {text.begin(), text.end()}; }

/// Checks that `read` throws an InputError whose one line begins with `start` and holds `part`.
inline void check_fails(const std::function<void()>& read, const std::string& start, const std::string& part) {
  try {
    read();
    FAIL_CHECK("accepted, expected: " << start << part);
  } catch (const InputError& error) {
    const std::string message = error.what();
    CHECK_THAT(message, Catch::StartsWith(start));
    CHECK_THAT(message, Catch::Contains(part));
    CHECK(message.find('\n') == std::string::npos);
    CHECK(message.size() < 400);
    CHECK(error.code() == ExitCode::input);
  }
}

}  // namespace hemiray::test
