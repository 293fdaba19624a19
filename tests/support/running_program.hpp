// The program under test while it runs: on a terminal, with signals, with a limit on file sizes.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <functional>
#include <map>
#include <regex>
#include <string>
#include <vector>

namespace hemiray::test {

struct RunSetup {
  std::vector<std::string> arguments;
  std::map<std::string, std::string> environment;  ///< set on top of this test's
  bool terminal = false;                           ///< stderr is a pseudo-terminal of 80 columns, else a pipe
  std::uint64_t file_size_limit = 0;               ///< RLIMIT_FSIZE [bytes]; 0: none
  std::string stdout_file = "/dev/null";
};

struct ProgramEnd {
  bool by_signal = false;
  int number = 0;   ///< the exit code, or the signal that ended it
  std::string err;  ///< everything it wrote to stderr (a terminal turns \n into \r\n)
};

/// Starts the program (compile definition HR_PROGRAM); one that still runs is killed on destruction. All waiting ends
/// with std::runtime_error after 60 s.
class RunningProgram {
 public:
  explicit RunningProgram(const RunSetup& setup);
  ~RunningProgram();
  RunningProgram(const RunningProgram&) = delete;
  RunningProgram& operator=(const RunningProgram&) = delete;

  /// Reads stderr until it holds `text`. Throws if the program ends before.
  void wait_for(const std::string& text);
  void wait_for(const std::regex& pattern);
  void send(int signal_number) const;
  /// Reads stderr to its end and waits for the program.
  ProgramEnd wait();

 private:
  bool read_some();  // false at the end of stderr
  void read_until(const std::function<bool()>& said, const std::string& what);

  pid_t child_ = -1;
  int stderr_ = -1;
  std::string err_;
};

}  // namespace hemiray::test
