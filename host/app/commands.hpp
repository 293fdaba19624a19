// The program's subcommands; one file each.
#pragma once

#include <CLI/CLI.hpp>

namespace hemiray::app {

// Each adds one subcommand to `app`. Its callback sets `exit_code`, or throws hemiray::Error, which main() prints as
// one line on stderr and turns into the exit code.
void add_render_command(CLI::App& app, int& exit_code);
void add_devices_command(CLI::App& app, int& exit_code);
void add_check_command(CLI::App& app, int& exit_code);
void add_compare_command(CLI::App& app, int& exit_code);
void add_bench_command(CLI::App& app, int& exit_code);
void add_solve_command(CLI::App& app, int& exit_code);
void add_view_factors_command(CLI::App& app, int& exit_code);
void add_tune_command(CLI::App& app, int& exit_code);
void add_stability_command(CLI::App& app, int& exit_code);

}  // namespace hemiray::app
