// Runs the built hemiray program from a test and catches what it prints.
#pragma once

#include <map>
#include <string>
#include <vector>

namespace hemiray::test {

struct ProgramResult {
  int exit_code = 0;  ///< as a shell shows it: 128 + signal where a signal ended the program
  std::string out;    ///< everything it wrote to stdout
  std::string err;    ///< everything it wrote to stderr
};

/// Runs the program under test (compile definition HR_PROGRAM) with these arguments, stdin empty, and this test's
/// environment with `environment` set on top. Throws std::runtime_error where it cannot be started, or has not ended
/// after 60 s (it is killed then).
[[nodiscard]] ProgramResult run_program(const std::vector<std::string>& arguments,
                                        const std::map<std::string, std::string>& environment = {});

}  // namespace hemiray::test
