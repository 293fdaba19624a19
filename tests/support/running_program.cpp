// fork and exec, because posix_spawn sets no resource limits.
#include "tests/support/running_program.hpp"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/ioctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <stdexcept>

namespace hemiray::test {
namespace {

constexpr int kTimeoutMs = 60'000;
constexpr int kCannotStart = 127;

[[noreturn]] void fail(const std::string& doing) { throw std::runtime_error(doing + ": " + std::strerror(errno)); }

// Both ends of a pseudo-terminal, or of a pipe: {ours, the program's}.
std::array<int, 2> open_terminal() {
  const int ours = posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC);
  if (ours < 0 || grantpt(ours) != 0 || unlockpt(ours) != 0) fail("pseudo-terminal");
  const int theirs = open(ptsname(ours), O_RDWR | O_NOCTTY | O_CLOEXEC);
  if (theirs < 0) fail("pseudo-terminal");
  winsize size{};
  size.ws_row = 24;
  size.ws_col = 80;
  if (ioctl(theirs, TIOCSWINSZ, &size) != 0) fail("pseudo-terminal");
  return {ours, theirs};
}

std::array<int, 2> open_pipe() {
  std::array<int, 2> ends{-1, -1};
  if (pipe2(ends.data(), O_CLOEXEC) != 0) fail("pipe");
  return ends;
}

// In the child: never returns.
[[noreturn]] void become_program(const RunSetup& setup, std::vector<char*>& argv, int error_end) {
  const int input = open("/dev/null", O_RDONLY);
  const int output = open(setup.stdout_file.c_str(), O_WRONLY);
  bool good = input >= 0 && output >= 0 && dup2(input, STDIN_FILENO) >= 0 && dup2(output, STDOUT_FILENO) >= 0 &&
              dup2(error_end, STDERR_FILENO) >= 0;
  for (const auto& [name, value] : setup.environment) good = good && setenv(name.c_str(), value.c_str(), 1) == 0;
  unsetenv("COLUMNS");
  if (setup.file_size_limit > 0) {
    const rlimit limit{setup.file_size_limit, setup.file_size_limit};
    const rlimit no_core{0, 0};
    good = good && setrlimit(RLIMIT_FSIZE, &limit) == 0 && setrlimit(RLIMIT_CORE, &no_core) == 0;
  }
  if (good) execv(HR_PROGRAM, argv.data());
  _exit(kCannotStart);
}

}  // namespace

RunningProgram::RunningProgram(const RunSetup& setup) {
  std::vector<std::string> words{HR_PROGRAM};
  words.insert(words.end(), setup.arguments.begin(), setup.arguments.end());
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  const std::array<int, 2> ends = setup.terminal ? open_terminal() : open_pipe();
  stderr_ = ends[0];
  child_ = fork();
  if (child_ == 0) become_program(setup, argv, ends[1]);
  close(ends[1]);
  if (child_ < 0) fail("fork");
}

RunningProgram::~RunningProgram() {
  if (child_ > 0) {
    kill(child_, SIGKILL);
    waitpid(child_, nullptr, 0);
  }
  close(stderr_);
}

bool RunningProgram::read_some() {
  pollfd waiting{stderr_, POLLIN, 0};
  if (poll(&waiting, 1, kTimeoutMs) == 0) throw std::runtime_error("no end in time; stderr so far: " + err_);
  std::array<char, 4096> buffer{};
  const ssize_t count = read(stderr_, buffer.data(), buffer.size());
  if (count < 0) return errno == EINTR;  // EIO: the last process on the terminal is gone
  err_.append(buffer.data(), static_cast<std::size_t>(count));
  return count > 0;
}

void RunningProgram::read_until(const std::function<bool()>& said, const std::string& what) {
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::milliseconds(kTimeoutMs);
  while (!said()) {
    if (std::chrono::steady_clock::now() > deadline || !read_some()) {
      throw std::runtime_error("stderr never said " + what + "; it said: " + err_);
    }
  }
}

void RunningProgram::wait_for(const std::string& text) {
  read_until([&] { return err_.find(text) != std::string::npos; }, "\"" + text + "\"");
}

void RunningProgram::wait_for(const std::regex& pattern) {
  read_until([&] { return std::regex_search(err_, pattern); }, "what was waited for");
}

void RunningProgram::send(int signal_number) const {
  if (kill(child_, signal_number) != 0) fail("kill");
}

ProgramEnd RunningProgram::wait() {
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::milliseconds(kTimeoutMs);
  while (read_some()) {
    if (std::chrono::steady_clock::now() > deadline) throw std::runtime_error("no end in time; stderr: " + err_);
  }
  int status = 0;
  while (waitpid(child_, &status, 0) < 0) {
    if (errno != EINTR) fail("waitpid");
  }
  child_ = -1;
  if (WIFEXITED(status)) return {false, WEXITSTATUS(status), err_};
  return {true, WTERMSIG(status), err_};
}

}  // namespace hemiray::test
