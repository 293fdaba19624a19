// The program: parses the command line, runs one subcommand, turns every error into one line and an exit code.
#include <signal.h>

#include <algorithm>
#include <cstdio>
#include <exception>
#include <new>
#include <string>
#include <string_view>
#include <vector>

#include <CLI/CLI.hpp>

#include "host/app/commands.hpp"
#include "host/base/build_info.hpp"
#include "host/base/error.hpp"
#include "host/base/spelling.hpp"

namespace {

constexpr const char* kFooter = R"(Examples:
  hemiray render scenes/cornell_box.json -o cornell.exr --png cornell.png
  hemiray check model.glb
  hemiray devices
  hemiray compare a.exr b.exr --tolerance relmse=1e-3
  hemiray bench --quick --peers --bars
  hemiray stability --rays 10000
'hemiray COMMAND --help' has more of each.

Exit codes: 0 done; 1 device or system; 2 usage or input; 3 a comparison beyond its tolerance, a bar not reached, a rung that does not hold; 130 interrupted.)";

// One line, whatever file names and drivers put into the message.
int fail(hemiray::ExitCode code, std::string message) {
  std::replace_if(
      message.begin(), message.end(), [](char c) { return (c >= 0 && c < ' ') || c == '\x7f'; }, ' ');
  std::fprintf(stderr, "hemiray: %s\n", message.c_str());
  return static_cast<int>(code);
}

// CLI11 lists all arguments that nobody took, the last one first: an option's value before the option.
std::string unknown_argument(const CLI::App& app) {
  const CLI::App& command = app.get_subcommands().empty() ? app : *app.get_subcommands().front();
  const std::vector<std::string> words = app.remaining(true);
  const auto is_option = [](const std::string& word) { return word.starts_with('-'); };
  const auto option = std::find_if(words.begin(), words.end(), is_option);
  if (option == words.end()) return hemiray::in_quotes(words.front()) + " is one argument too many";
  std::vector<std::string_view> names;
  for (const CLI::Option* known : command.get_options()) {
    names.insert(names.end(), known->get_lnames().begin(), known->get_lnames().end());
  }
  const std::string given = option->substr(0, option->find('='));
  const std::string_view near = hemiray::nearest_spelling(
      std::string_view(given).substr(std::min(given.find_first_not_of('-'), given.size())), names);
  return hemiray::in_quotes(given) + " is not an option of '" + command.get_name() + "'; " +
         (near.empty() ? "see 'hemiray " + command.get_name() + " --help'"
                       : "did you mean --" + std::string(near) + "?");
}

// CLI11 only says that a command is missing where an unknown one is given.
std::string usage_error(const CLI::App& app, const CLI::ParseError& error, int argc, char** argv) {
  const std::string_view word = argc > 1 ? argv[1] : "";
  const bool names_command = !word.empty() && word.front() != '-' && app.get_subcommands().empty();
  if (dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr) return unknown_argument(app);
  if (!names_command) return std::string(error.what()) + "; see 'hemiray --help'";
  std::vector<std::string_view> names;
  for (const CLI::App* command : app.get_subcommands({})) names.push_back(command->get_name());
  return hemiray::in_quotes(word) + " is not a command" + hemiray::spelling_hint(word, names);
}

int run(int argc, char** argv) {
  using hemiray::ExitCode;
  CLI::App app("hemiray: a portable OpenCL renderer");
  app.set_version_flag("--version", std::string("hemiray ") + hemiray::kVersion + " (" + hemiray::kCommit + ")");
  app.require_subcommand(1);
  app.footer(kFooter);
  int exit_code = 0;
  hemiray::app::add_render_command(app, exit_code);
  hemiray::app::add_check_command(app, exit_code);
  hemiray::app::add_compare_command(app, exit_code);
  hemiray::app::add_devices_command(app, exit_code);
  hemiray::app::add_bench_command(app, exit_code);
  hemiray::app::add_solve_command(app, exit_code);
  hemiray::app::add_view_factors_command(app, exit_code);
  hemiray::app::add_tune_command(app, exit_code);
  hemiray::app::add_stability_command(app, exit_code);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // --help, --version
    return fail(ExitCode::input, usage_error(app, error, argc, argv));
  }
  if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0) return fail(ExitCode::device, "stdout: cannot write to it");
  return exit_code;
}

}  // namespace

int main(int argc, char** argv) {
  using hemiray::ExitCode;
  signal(SIGXFSZ, SIG_IGN);  // a limit on file sizes shows as an error of write(), which removes the temporary file
  try {
    return run(argc, argv);
  } catch (const hemiray::Error& error) {
    return fail(error.code(), error.what());
  } catch (const std::bad_alloc&) {
    return fail(ExitCode::device, "out of memory on the host");
  } catch (const std::exception& error) {
    return fail(ExitCode::device, std::string("internal error: ") + error.what());
  }
}
