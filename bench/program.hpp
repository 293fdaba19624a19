// What the benchmark's programs share: options, errors and exit codes as the commands have them.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <functional>
#include <string>

#include "host/base/error.hpp"

namespace hemiray::bench {

/// Parses the options and calls work(). Returns 0, 2 for options and input that cannot be, 1 for what else goes wrong,
/// which is told on stderr.
inline int run_program(CLI::App& app, int argc, char** argv, const std::function<void()>& work) {
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;  // --help is 0
  }
  try {
    work();
    return 0;
  } catch (const std::exception& error) {
    std::fputs((std::string(error.what()) + "\n").c_str(), stderr);
    return dynamic_cast<const InputError*>(&error) != nullptr ? 2 : 1;
  }
}

}  // namespace hemiray::bench
