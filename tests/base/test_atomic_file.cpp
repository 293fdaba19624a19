// Whole files or none: what stands in the folder after success and after every kind of failure.
#include "host/base/atomic_file.hpp"

#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <string>

#include "host/base/error.hpp"
#include "tests/support/temp_folder.hpp"

using hemiray::check_writable;
using hemiray::DeviceError;
using hemiray::InputError;
using hemiray::is_same_file;
using hemiray::write_file_atomically;
using hemiray::test::read_whole_file;
using hemiray::test::TempFolder;
namespace fs = std::filesystem;

namespace {

std::size_t entries(const fs::path& folder) {
  return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}

mode_t permissions(const fs::path& path) {
  struct stat status {};
  REQUIRE(stat(path.c_str(), &status) == 0);
  return status.st_mode & 07777;
}

/// Files cannot grow beyond this while it lives: the write fails as on a full disk.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) {
    old_handler_ = signal(SIGXFSZ, SIG_IGN);
    getrlimit(RLIMIT_FSIZE, &old_);
    rlimit limit = old_;
    limit.rlim_cur = bytes;
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FileSizeLimit() {
    setrlimit(RLIMIT_FSIZE, &old_);
    signal(SIGXFSZ, old_handler_);
  }
  FileSizeLimit(const FileSizeLimit&) = delete;
  FileSizeLimit& operator=(const FileSizeLimit&) = delete;

 private:
  rlimit old_{};
  sighandler_t old_handler_;
};

}  // namespace

TEST_CASE("atomic file: a new file, then another content, and nothing else in the folder") {
  const TempFolder folder;
  write_file_atomically(folder / "result.bin", std::string("first\0half", 10));
  CHECK(read_whole_file(folder / "result.bin") == std::string("first\0half", 10));
  write_file_atomically(folder / "result.bin", "second");
  CHECK(read_whole_file(folder / "result.bin") == "second");
  write_file_atomically(folder / "empty.bin", "");
  CHECK(read_whole_file(folder / "empty.bin").empty());
  CHECK(entries(folder.path()) == 2);
}

TEST_CASE("atomic file: permissions follow the umask, those of a replaced file are kept") {
  const TempFolder folder;
  const mode_t old_mask = umask(027);
  write_file_atomically(folder / "new.bin", "x");
  umask(old_mask);
  CHECK(permissions(folder / "new.bin") == 0640);
  chmod((folder / "new.bin").c_str(), 0604);
  write_file_atomically(folder / "new.bin", "y");
  CHECK(permissions(folder / "new.bin") == 0604);
}

TEST_CASE("names of one file are told as such, whether it is there or not") {
  CHECK(is_same_file("a.npy", "./a.npy"));
  CHECK(is_same_file("a.npy", fs::current_path() / "a.npy"));
  CHECK(is_same_file("sub/../a.npy", "a.npy"));
  CHECK_FALSE(is_same_file("a.npy", "b.npy"));
}

TEST_CASE("atomic file: links are followed, also those that point to nothing yet") {
  const TempFolder folder;
  fs::create_directory(folder / "there");
  fs::create_symlink("there/target.bin", folder / "link.bin");
  write_file_atomically(folder / "link.bin", "through");
  CHECK(fs::is_symlink(folder / "link.bin"));
  CHECK(read_whole_file(folder / "there" / "target.bin") == "through");
  write_file_atomically(folder / "link.bin", "again");
  CHECK(read_whole_file(folder / "there" / "target.bin") == "again");
  fs::create_symlink("loop.bin", folder / "loop.bin");
  CHECK_THROWS_AS(check_writable(folder / "loop.bin"), InputError);
}

TEST_CASE("atomic file: a name in the working folder") {
  const TempFolder folder;
  const fs::path before = fs::current_path();
  fs::current_path(folder.path());
  const auto back = [&] { fs::current_path(before); };
  try {
    check_writable("plain.bin");
    write_file_atomically("plain.bin", "here");
  } catch (...) {
    back();
    throw;
  }
  back();
  CHECK(read_whole_file(folder / "plain.bin") == "here");
}

TEST_CASE("atomic file: a failed write leaves the old file and no temporary") {
  const TempFolder folder;
  write_file_atomically(folder / "result.bin", "old");
  {
    const FileSizeLimit limit(1000);
    CHECK_THROWS_AS(write_file_atomically(folder / "result.bin", std::string(5000, 'x')), DeviceError);
    CHECK_THROWS_AS(write_file_atomically(folder / "other.bin", std::string(5000, 'x')), DeviceError);
  }
  CHECK(read_whole_file(folder / "result.bin") == "old");
  CHECK(entries(folder.path()) == 1);
}

TEST_CASE("atomic file: no room to write is an error of the system, exit code 1") {
  const TempFolder folder;
  const FileSizeLimit limit(0);
  try {
    write_file_atomically(folder / "result.bin", "x");
    FAIL("written in spite of the limit");
  } catch (const DeviceError& error) {
    CHECK(error.code() == hemiray::ExitCode::device);
    CHECK_THAT(error.what(), Catch::StartsWith((folder / "result.bin").string()) && Catch::Contains("free some space"));
  }
}

TEST_CASE("atomic file: unwritable names are told before and while writing, exit code 2") {
  const TempFolder folder;
  folder.write("file.bin", "x");
  fs::create_directory(folder / "folder");
  REQUIRE(mkfifo((folder / "pipe").c_str(), 0600) == 0);
  const std::string long_name(300, 'n');
  for (const fs::path& path :
       {fs::path(), folder.path() / "", folder / "missing/result.bin", folder / "file.bin/result.bin",
        folder / "folder", folder / long_name, folder / "pipe", fs::path("/proc/hemiray.bin")}) {
    INFO(path);
    CHECK_THROWS_AS(check_writable(path), InputError);
    CHECK_THROWS_AS(write_file_atomically(path, "x"), InputError);
  }
  CHECK(fs::is_fifo(folder / "pipe"));
  CHECK(entries(folder.path()) == 3);
}

TEST_CASE("atomic file: read-only folders and files are told") {
  if (geteuid() == 0) return;  // root may write everywhere; /proc above stands in for it
  const TempFolder folder;
  folder.write("file.bin", "x");
  chmod((folder / "file.bin").c_str(), 0444);
  CHECK_THROWS_AS(check_writable(folder / "file.bin"), InputError);
  chmod(folder.path().c_str(), 0555);
  CHECK_THROWS_AS(check_writable(folder / "other.bin"), InputError);
  chmod(folder.path().c_str(), 0755);
}

TEST_CASE("check_writable leaves everything as it was") {
  const TempFolder folder;
  folder.write("old.bin", "old");
  check_writable(folder / "old.bin");
  check_writable(folder / "new.bin");
  CHECK(read_whole_file(folder / "old.bin") == "old");
  CHECK(entries(folder.path()) == 1);
}
