#include "host/app/bench_plot.hpp"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <string>
#include <vector>

#include "host/app/data_files.hpp"
#include "host/base/error.hpp"

namespace hemiray::app {
namespace {

// Runs an interpreter and returns its exit code; 127 where there is none. `quiet`: without its stdout and stderr.
int run_python(const std::string& python, const std::vector<std::string>& arguments, bool quiet) {
  std::vector<std::string> words{python};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);

  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  if (quiet) {
    posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
  } else {
    posix_spawn_file_actions_adddup2(&actions, STDERR_FILENO, STDOUT_FILENO);  // stdout is for the tables
  }
  pid_t child = 0;
  const int error = posix_spawnp(&child, argv[0], &actions, nullptr, argv.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (error != 0) return 127;
  int status = 0;
  while (waitpid(child, &status, 0) < 0) {
    if (errno != EINTR) return 127;
  }
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

// The first interpreter that has matplotlib: the one named by the environment, else the path's, else the system's, for
// which Debian's package is. Throws InputError where there is none.
std::string find_python() {
  std::vector<std::string> candidates{"python3", "/usr/bin/python3"};
  if (const char* chosen = std::getenv("HEMIRAY_PYTHON"); chosen != nullptr && *chosen != '\0') candidates = {chosen};
  for (const std::string& python : candidates) {
    if (run_python(python, {"-c", "import matplotlib"}, true) == 0) return python;
  }
  throw InputError("--plot", "needs " + candidates.front() + " with matplotlib; install python3-matplotlib");
}

}  // namespace

void check_plotting() { find_python(); }

void plot_results(const std::filesystem::path& json, const std::filesystem::path& folder) {
  const std::string script = data_file("bench/plot.py").string();
  const int code = run_python(find_python(), {"-B", script, json.string(), folder.string()}, false);
  if (code != 0) throw DeviceError("--plot: " + script + " failed with exit code " + std::to_string(code));
}

}  // namespace hemiray::app
