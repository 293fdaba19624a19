// The progress line on wide and narrow terminals, what reaches a terminal and a pipe; numbers; interrupts.
#include "host/base/progress.hpp"

#include <pty.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <limits>
#include <thread>

#include "host/base/interrupt.hpp"
#include "host/base/numbers.hpp"

using hemiray::InterruptGuard;
using hemiray::Progress;
using hemiray::progress_line;
using hemiray::ProgressState;

namespace {

// Runs `work` in a child process and returns how it ended. Nothing of Catch may run there, so it ends with _exit.
int in_child(const std::function<void()>& work) {
  const pid_t child = fork();
  REQUIRE(child >= 0);
  if (child == 0) {
    signal(SIGINT, SIG_DFL);  // not Catch's handlers
    signal(SIGTERM, SIG_DFL);
    work();
    _exit(0);
  }
  int status = 0;
  REQUIRE(waitpid(child, &status, 0) == child);
  return status;
}

// What a child writes to a terminal of `columns` that is its stderr.
std::string on_terminal(unsigned short columns, const std::function<void()>& work) {
  winsize size{};
  size.ws_col = columns;
  size.ws_row = 24;
  int terminal = -1;
  const pid_t child = forkpty(&terminal, nullptr, nullptr, &size);
  REQUIRE(child >= 0);
  if (child == 0) {
    unsetenv("COLUMNS");
    work();
    _exit(0);
  }
  std::string text;
  std::array<char, 1024> buffer{};
  ssize_t count = 0;
  while ((count = read(terminal, buffer.data(), buffer.size())) > 0)
    text.append(buffer.data(), static_cast<std::size_t>(count));
  close(terminal);
  waitpid(child, nullptr, 0);
  return text;
}

void work_for(Progress& progress, std::chrono::milliseconds time) {
  const auto start = std::chrono::steady_clock::now();
  for (auto now = start; now - start < time; now = std::chrono::steady_clock::now()) {
    progress.update(std::chrono::duration<double>(now - start) / time, 2e6);
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
}

}  // namespace

TEST_CASE("progress: the whole line at 80 columns") {
  const std::string line = progress_line("render", {0.25, 12.34e6, 10}, 80);
  CHECK(line == "render [########.........................]  25 %  12.3 Mrays/s  10 s  30 s left");
  CHECK_THAT(progress_line("render", {0.25, 0, 10}, 80), !Catch::Contains("rays"));
}

TEST_CASE("progress: every width holds a line that fits, and the percentage stays longest") {
  const ProgressState state{0.42, 1e6, 100};
  for (std::size_t columns = 0; columns < 300; ++columns) {
    const std::string line = progress_line("render", state, columns);
    INFO(columns << ": " << line);
    CHECK((line.empty() || line.size() < columns));
    if (columns > 6) CHECK_THAT(line, Catch::Contains("42 %"));
  }
  CHECK_THAT(progress_line("render", state, 20), !Catch::Contains("["));
}

TEST_CASE("progress: fractions outside 0 to 1") {
  CHECK_THAT(progress_line("x", {2, 0, 1}, 80), Catch::Contains("100 %"));
  CHECK_THAT(progress_line("x", {-1, 0, 1}, 80), Catch::Contains("  0 %") && !Catch::Contains("left"));
  CHECK_THAT(progress_line("x", {std::nan(""), 0, 1}, 80), Catch::Contains("  0 %"));
  CHECK_THAT(progress_line("x", {0.999, 0, 1}, 80), Catch::Contains(" 99 %"));
}

TEST_CASE("progress: a terminal sees at most ten lines a second after the first, and a clean line at the end") {
  const std::string text = on_terminal(60, [] {
    Progress progress("render", true);
    work_for(progress, std::chrono::milliseconds(1550));
    progress.finish();
    progress.update(0.5, 1);
  });
  CHECK_THAT(text, Catch::Contains("render [") && Catch::Contains("2.00 Mrays/s") && Catch::EndsWith(" \r"));
  const auto lines = std::count(text.begin(), text.end(), '%');
  CHECK(lines >= 1);
  CHECK(lines <= 6);
  CHECK(text.find('\n') == std::string::npos);
  CHECK(text.find('\x1b') == std::string::npos);
}

TEST_CASE("progress: short work, quiet and pipes see nothing") {
  CHECK(on_terminal(60, [] {
          Progress progress("render", true);
          work_for(progress, std::chrono::milliseconds(300));
        }).empty());
  CHECK(on_terminal(60, [] {
          Progress progress("render", false);
          work_for(progress, std::chrono::milliseconds(1200));
        }).empty());
  std::array<int, 2> ends{};
  REQUIRE(pipe(ends.data()) == 0);
  in_child([&] {
    dup2(ends[1], STDERR_FILENO);
    Progress progress("render", true);
    work_for(progress, std::chrono::milliseconds(1200));
  });
  close(ends[1]);
  char byte = 0;
  CHECK(read(ends[0], &byte, 1) == 0);
  close(ends[0]);
}

TEST_CASE("numbers: bytes, counts, rates, durations") {
  using namespace hemiray;
  CHECK(format_bytes(0) == "0 B");
  CHECK(format_bytes(1023) == "1023 B");
  CHECK(format_bytes(1536) == "1.50 KiB");
  CHECK(format_bytes(1048575) == "1.00 MiB");
  CHECK(format_bytes(std::uint64_t{36} << 30U) == "36.0 GiB");
  CHECK(format_bytes(std::numeric_limits<std::uint64_t>::max()) == "16.0 EiB");
  CHECK(format_count(9999) == "9999");
  CHECK(format_count(12345) == "12.3 k");
  CHECK(format_count(0, "node") == "0 nodes");
  CHECK(format_count(1, "node") == "1 node");
  CHECK(format_count(12345, "node") == "12.3 k nodes");
  CHECK(format_count(999999) == "1.00 M");
  CHECK(format_rate(12.34e6, "rays/s") == "12.3 Mrays/s");
  CHECK(format_rate(0, "rays/s") == "0.00 rays/s");
  CHECK(format_rate(std::nan(""), "rays/s") == "-");
  CHECK(format_duration(0) == "0 s");
  CHECK(format_duration(850e-9) == "850 ns");
  CHECK(format_duration(1.5e-5) == "15.0 us");
  CHECK(format_duration(0.0123) == "12.3 ms");
  CHECK(format_duration(0.99999) == "1.00 s");
  CHECK(format_duration(59.99) == "1 min 00 s");
  CHECK(format_duration(125) == "2 min 05 s");
  CHECK(format_duration(3599.9) == "1 h 00 min");
  CHECK(format_duration(3 * 3600 + 7 * 60 + 29) == "3 h 07 min");
  CHECK(format_duration(-1) == "-");
}

TEST_CASE("interrupt: the first signal sets the flag, the next one ends the process") {
  const int number = GENERATE(SIGINT, SIGTERM);
  const int once = in_child([number] {
    const InterruptGuard guard;
    if (guard.interrupted()) _exit(1);
    raise(number);
    _exit(guard.interrupted() ? 42 : 2);
  });
  CHECK(WEXITSTATUS(once) == 42);
  const int twice = in_child([number] {
    const InterruptGuard guard;
    raise(SIGINT);
    raise(number);
    _exit(3);
  });
  REQUIRE(WIFSIGNALED(twice));
  CHECK(WTERMSIG(twice) == number);
}

TEST_CASE("interrupt: the handler before comes back, ignored signals stay ignored, a new guard starts afresh") {
  const int restored = in_child([] {
    {
      const InterruptGuard guard;
      raise(SIGINT);
    }
    {
      const InterruptGuard fresh;
      if (fresh.interrupted()) _exit(1);
    }
    raise(SIGINT);
    _exit(2);
  });
  REQUIRE(WIFSIGNALED(restored));
  CHECK(WTERMSIG(restored) == SIGINT);
  const int ignored = in_child([] {
    signal(SIGINT, SIG_IGN);
    const InterruptGuard guard;
    raise(SIGINT);
    _exit(guard.interrupted() ? 1 : 42);
  });
  CHECK(WEXITSTATUS(ignored) == 42);
}
