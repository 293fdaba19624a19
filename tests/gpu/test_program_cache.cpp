// The cache of compiled programs on disk: what goes in comes out, and nothing else does.
#include <catch2/catch.hpp>

#include <sys/wait.h>
#include <unistd.h>

#include <set>
#include <string>
#include <thread>
#include <vector>

#include "host/gpu/program_cache.hpp"
#include "tests/support/kernel_folder.hpp"
#include "tests/support/temp_folder.hpp"

namespace hemiray {
namespace {

CompiledProgram sample_program(unsigned char fill, std::size_t size) {
  CompiledProgram program;
  for (std::size_t i = 0; i < size; i++) program.binary.push_back(static_cast<unsigned char>(fill + i * 7));
  program.binary.push_back('\n');
  program.argument_names = {{"first_kernel", {"nodes", "count"}}, {"without_arguments", {}}};
  return program;
}

bool same(const CompiledProgram& a, const CompiledProgram& b) {
  return a.binary == b.binary && a.argument_names == b.argument_names;
}

bool is_stored(const std::filesystem::path& folder, const std::string& key, const CompiledProgram& program) {
  const std::optional<CompiledProgram> loaded = load_program(folder, key);
  return loaded && same(*loaded, program);
}

std::size_t files_in(const std::filesystem::path& folder) {
  std::size_t count = 0;
  for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(folder)) count++;
  return count;
}

// Stores `program` many times while other writers do the same; false if that ever failed.
bool store_often(const std::filesystem::path& folder, const std::string& key, const CompiledProgram& program) {
  bool all = true;
  for (int i = 0; i < 200; i++) all = store_program(folder, key, program) && all;
  return all;
}

}  // namespace

TEST_CASE("a stored program comes back whole, from a folder made on the way") {
  const test::TempFolder temp;
  const std::filesystem::path folder = temp / "new/cache";
  const CompiledProgram program = sample_program(1, 5000);
  CHECK_FALSE(load_program(folder, "key"));
  CHECK(store_program(folder, "key", program));
  CHECK(is_stored(folder, "key", program));
  CHECK_FALSE(load_program(folder, "other"));
  const CompiledProgram next = sample_program(2, 10);
  CHECK(store_program(folder, "key", next));
  CHECK(is_stored(folder, "key", next));
  CHECK(files_in(folder) == 1);
}

TEST_CASE("the key changes with the text, the options and everything about the driver") {
  const DeviceInfo device = [] {
    DeviceInfo info;
    info.name = "device";
    info.version = "OpenCL 3.0";
    info.driver = "3.1";
    info.platform = "platform";
    info.platform_version = "OpenCL 3.0 one";
    return info;
  }();
  std::set<std::string> keys = {program_key("text", "-O", device)};
  CHECK(keys.begin()->size() == 64);
  CHECK(program_key("text", "-O", device) == *keys.begin());
  keys.insert(program_key("texu", "-O", device));
  keys.insert(program_key("text ", "-O", device));
  keys.insert(program_key("text-", "O", device));  // the same letters, parted elsewhere
  keys.insert(program_key("text", "-P", device));
  for (std::string DeviceInfo::*member : {&DeviceInfo::name, &DeviceInfo::version, &DeviceInfo::driver,
                                          &DeviceInfo::platform, &DeviceInfo::platform_version}) {
    DeviceInfo other = device;
    other.*member += "'";
    keys.insert(program_key("text", "-O", other));
  }
  CHECK(keys.size() == 10);
}

TEST_CASE("a truncated or lengthened entry is refused") {
  const test::TempFolder folder;
  REQUIRE(store_program(folder.path(), "key", sample_program(3, 300)));
  const std::string whole = test::read_whole_file(folder / "key.bin");
  for (std::size_t length = 0; length < whole.size(); length++) {
    folder.write("key.bin", whole.substr(0, length));
    INFO("cut to " << length << " of " << whole.size() << " bytes");
    REQUIRE_FALSE(load_program(folder.path(), "key"));
  }
  folder.write("key.bin", whole + '\0');
  CHECK_FALSE(load_program(folder.path(), "key"));
  folder.write("key.bin", whole);
  CHECK(is_stored(folder.path(), "key", sample_program(3, 300)));
}

TEST_CASE("an entry with any one bit flipped is refused") {
  const test::TempFolder folder;
  REQUIRE(store_program(folder.path(), "key", sample_program(4, 40)));
  const std::string whole = test::read_whole_file(folder / "key.bin");
  for (std::size_t bit = 0; bit < whole.size() * 8; bit++) {
    std::string damaged = whole;
    damaged[bit / 8] = static_cast<char>(damaged[bit / 8] ^ (1 << bit % 8));
    folder.write("key.bin", damaged);
    INFO("byte " << bit / 8 << ", bit " << bit % 8);
    REQUIRE_FALSE(load_program(folder.path(), "key"));
  }
}

TEST_CASE("a foreign entry is refused: another file, another key's entry, a folder") {
  const test::TempFolder folder;
  for (const char* content : {"", "\n", "hemiray program 1\n",
                              "not ours at all, but long enough to hold a header: "
                              "0123456789012345678901234567890123456789"}) {
    folder.write("key.bin", content);
    INFO("content '" << content << "'");
    CHECK_FALSE(load_program(folder.path(), "key"));
  }
  REQUIRE(store_program(folder.path(), "another", sample_program(5, 20)));
  folder.write("key.bin", test::read_whole_file(folder / "another.bin"));
  CHECK_FALSE(load_program(folder.path(), "key"));
  std::filesystem::create_directory(folder / "folder.bin");
  CHECK_FALSE(load_program(folder.path(), "folder"));
}

TEST_CASE("two processes write one entry at a time: a reader always finds a whole one") {
  const test::TempFolder folder;
  const CompiledProgram programs[2] = {sample_program(6, 200000), sample_program(7, 100000)};
  REQUIRE(store_program(folder.path(), "key", programs[0]));
  pid_t children[2];
  for (int i = 0; i < 2; i++) {
    children[i] = fork();
    REQUIRE(children[i] >= 0);
    if (children[i] == 0) _exit(store_often(folder.path(), "key", programs[i]) ? 0 : 1);
  }
  int ended = 0, statuses[2] = {-1, -1};
  int whole = 0, reads = 0;
  while (ended < 2) {
    const std::optional<CompiledProgram> loaded = load_program(folder.path(), "key");
    reads++;
    if (loaded && (same(*loaded, programs[0]) || same(*loaded, programs[1]))) whole++;
    for (int i = 0; i < 2; i++) {
      if (statuses[i] == -1 && waitpid(children[i], &statuses[i], WNOHANG) == children[i]) ended++;
    }
  }
  CHECK(statuses[0] == 0);
  CHECK(statuses[1] == 0);
  CHECK(reads > 0);
  CHECK(whole == reads);
  CHECK(files_in(folder.path()) == 1);
}

TEST_CASE("two threads write one entry at a time: a reader always finds a whole one") {
  const test::TempFolder folder;
  const CompiledProgram programs[2] = {sample_program(8, 200000), sample_program(9, 100000)};
  REQUIRE(store_program(folder.path(), "key", programs[0]));
  bool stored[2] = {false, false};
  std::vector<std::thread> writers;
  for (int i = 0; i < 2; i++) {
    writers.emplace_back([&, i] { stored[i] = store_often(folder.path(), "key", programs[i]); });
  }
  int whole = 0;
  constexpr int kReads = 200;
  for (int read = 0; read < kReads; read++) {
    const std::optional<CompiledProgram> loaded = load_program(folder.path(), "key");
    if (loaded && (same(*loaded, programs[0]) || same(*loaded, programs[1]))) whole++;
  }
  for (std::thread& writer : writers) writer.join();
  CHECK(whole == kReads);
  CHECK(stored[0]);
  CHECK(stored[1]);
  CHECK(files_in(folder.path()) == 1);
}

TEST_CASE("a cache that cannot be written is no error and leaves nothing") {
  const test::TempFolder folder;
  folder.write("file", "in the way");
  CHECK_FALSE(store_program(folder / "file/below", "key", sample_program(1, 1)));
  CHECK_FALSE(load_program(folder / "file/below", "key"));
  CHECK_FALSE(store_program("", "key", sample_program(1, 1)));
  CHECK_FALSE(load_program("", "key"));
  std::filesystem::create_directories(folder / "taken/key.bin/below");  // the entry's own name cannot be had
  CHECK_FALSE(store_program(folder / "taken", "key", sample_program(1, 1)));
  CHECK(files_in(folder / "taken") == 1);
}

TEST_CASE("the cache folder follows the environment") {
  const test::ScopedVariable own("HEMIRAY_CACHE_DIR", "somewhere");
  CHECK(program_cache_folder() == "somewhere");
  const test::ScopedVariable no_own("HEMIRAY_CACHE_DIR", std::nullopt);
  const test::ScopedVariable xdg("XDG_CACHE_HOME", "/caches");
  CHECK(program_cache_folder() == "/caches/hemiray");
  const test::ScopedVariable relative("XDG_CACHE_HOME", "caches");  // to be ignored, says the XDG specification
  const test::ScopedVariable home("HOME", "/home/me");
  CHECK(program_cache_folder() == "/home/me/.cache/hemiray");
  const test::ScopedVariable no_home("HOME", std::nullopt);
  CHECK(program_cache_folder().empty());
}

}  // namespace hemiray
