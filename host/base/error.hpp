// Errors as the user meets them: one message, one exit code.
#pragma once

#include <stdexcept>
#include <string>
#include <string_view>

namespace hemiray {

/// The program's exit codes (documented in README.md).
enum class ExitCode : int { ok = 0, device = 1, input = 2, verdict = 3, interrupted = 130 };

/// Base of all errors hemiray throws; `what()` is one line, without a trailing full stop or newline.
class Error : public std::runtime_error {
 public:
  Error(ExitCode code, const std::string& message) : std::runtime_error(message), code_(code) {}
  [[nodiscard]] ExitCode code() const noexcept { return code_; }

 private:
  ExitCode code_;
};

/// Bad input or usage (exit code 2). `place` names what is at fault: "file:line:column", "file: /json/path",
/// "--option".
class InputError : public Error {
 public:
  explicit InputError(const std::string& message) : Error(ExitCode::input, message) {}
  InputError(std::string_view place, std::string_view message)
      : Error(ExitCode::input, std::string(place) + ": " + std::string(message)) {}
};

/// The device or the system failed (exit code 1): out of memory, disk full, no OpenCL device.
class DeviceError : public Error {
 public:
  explicit DeviceError(const std::string& message) : Error(ExitCode::device, message) {}
};

}  // namespace hemiray
