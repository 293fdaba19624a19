// The program: parses the command line, runs one subcommand, turns every error into one line and an exit code.
#include <cstdio>
#include <exception>
#include <new>

#include <CLI/CLI.hpp>

#include "host/app/commands.hpp"
#include "host/base/build_info.hpp"
#include "host/base/error.hpp"

namespace {

constexpr const char* kFooter = R"(Examples:
  hemiray render scenes/cornell_box.json -o cornell.exr --png cornell.png
  hemiray check model.glb
  hemiray devices
  hemiray compare a.exr b.exr --tolerance relmse=1e-3
'hemiray COMMAND --help' has more of each.

Exit codes: 0 done; 1 device or system; 2 usage or input; 3 a comparison beyond its tolerance; 130 interrupted.)";

int fail(hemiray::ExitCode code, const char* message) {
  std::fprintf(stderr, "hemiray: %s\n", message);
  return static_cast<int>(code);
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
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // --help, --version
    return fail(ExitCode::input, (std::string(error.what()) + "; see 'hemiray --help'").c_str());
  }
  return exit_code;
}

}  // namespace

int main(int argc, char** argv) {
  using hemiray::ExitCode;
  try {
    return run(argc, argv);
  } catch (const hemiray::Error& error) {
    return fail(error.code(), error.what());
  } catch (const std::bad_alloc&) {
    return fail(ExitCode::device, "out of memory on the host");
  } catch (const std::exception& error) {
    return fail(ExitCode::device, (std::string("internal error: ") + error.what()).c_str());
  }
}
