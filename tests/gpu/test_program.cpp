// Compiling kernels and launching them with arguments by name.
#include <catch2/catch.hpp>

#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

#include "host/base/error.hpp"
#include "host/gpu/program.hpp"
#include "tests/support/kernel_folder.hpp"

namespace hemiray {
namespace {

constexpr const char* kProbe = R"(#include "probe/constant.h"
kernel void probe_fill(global uint* restrict values, const uint base, const uint stride, const uint count) {
  const uint i = (uint)get_global_id(0);
  if (i < count) values[i] = base + stride * i + PROBE_CONSTANT;
}
kernel __attribute__((reqd_work_group_size(HR_LOCAL_SIZE, 1, 1))) void probe_sizes(global uint* restrict values) {
  if (get_global_id(0) == 0) {
    values[0] = (uint)get_global_size(0);
    values[1] = (uint)get_local_size(0);
    values[2] = HR_FEATURES;
#ifdef HR_STRICT
    values[3] = 1;
#else
    values[3] = 0;
#endif
  }
}
)";

class Probe {
 public:
  explicit Probe(const ProgramOptions& options = {})
      : context(choose_device("")), folder(), program((write(), context), "probe", {"probe/probe.cl"}, options) {}

  Context context;

 private:
  void write() const {
    folder.write("probe/probe.cl", kProbe);
    folder.write("probe/constant.h", "#define PROBE_CONSTANT 1000\n");
  }
  test::KernelFolder folder;

 public:
  Program program;
};

std::string logic_error_of(Probe& probe, const Arguments& given) {
  try {
    launch(probe.context, probe.program.kernel("probe_fill"), 4, given);
  } catch (const std::logic_error& error) {
    return error.what();
  }
  return "none";
}

}  // namespace

TEST_CASE("arguments are bound by name, in any order") {
  Probe probe;
  Buffer<std::uint32_t> values(probe.context, "values", 100);
  values.clear();
  const std::uint32_t base = 7, step = 3, count = 90;
  launch(probe.context, probe.program.kernel("probe_fill"), 100,
         arguments(arg("count", count), arg("stride", step), arg("values", values), arg("base", base)));
  const std::vector<std::uint32_t> read = values.read();
  for (std::uint32_t i = 0; i < 100; i++) REQUIRE(read[i] == (i < count ? 1007 + 3 * i : 0));
}

TEST_CASE("a missing, unknown or surplus argument is a logic error that names kernel and argument") {
  Probe probe;
  const Buffer<std::uint32_t> values(probe.context, "values", 4);
  const Argument v = arg("values", values), b = arg("base", 1U), s = arg("stride", 1U), c = arg("count", 4U);
  CHECK(logic_error_of(probe, {v, b, s, c}) == "none");
  CHECK(logic_error_of(probe, {v, b, s}) == "kernel probe_fill takes 4 arguments, 3 given");
  CHECK(logic_error_of(probe, {v, b, s, c, arg("more", 1U)}) == "kernel probe_fill takes 4 arguments, 5 given");
  CHECK(logic_error_of(probe, {v, b, s, arg("counts", 4U)}) == "kernel probe_fill: argument 'count' is missing");
  CHECK(logic_error_of(probe, {v, v, s, c}) == "kernel probe_fill: argument 'base' is missing");
  CHECK(logic_error_of(probe, {}) == "kernel probe_fill takes 4 arguments, 0 given");
}

TEST_CASE("an argument of the wrong size is an error with the code's meaning, the kernel and the argument") {
  Probe probe;
  const Buffer<std::uint32_t> values(probe.context, "values", 4);
  const Arguments given =
      arguments(arg("values", values), arg("base", std::uint64_t{1}), arg("stride", 1U), arg("count", 4U));
  CHECK_THROWS_AS(launch(probe.context, probe.program.kernel("probe_fill"), 4, given), DeviceError);
  CHECK_THROWS_WITH(launch(probe.context, probe.program.kernel("probe_fill"), 4, given),
                    Catch::Contains("probe_fill") && Catch::Contains("'base'") && Catch::Contains("CL_INVALID_ARG"));
}

TEST_CASE("a kernel the program does not have is a logic error") {
  Probe probe;
  CHECK(probe.program.kernel_count() == 2);
  CHECK_THROWS_AS(probe.program.kernel("probe_none"), std::logic_error);
  CHECK_THROWS_WITH(probe.program.kernel("probe_none"), "program 'probe' has no kernel 'probe_none'");
}

TEST_CASE("launches are rounded up to the local size, and options reach the kernels") {
  for (const bool strict : {false, true}) {
    Probe probe(ProgramOptions{0x1234U, strict});
    Buffer<std::uint32_t> values(probe.context, "values", 4);
    const std::uint32_t local = probe.context.profile().local_size;
    for (const std::uint32_t items : {1U, local, local + 1}) {
      launch(probe.context, probe.program.kernel("probe_sizes"), items, arguments(arg("values", values)));
      const std::uint32_t rounded = (items + local - 1) / local * local;
      CHECK(values.read() == std::vector<std::uint32_t>{rounded, local, 0x1234U, strict ? 1U : 0U});
    }
    probe.context.finish();
    REQUIRE(probe.context.profiler().stages().size() == 1);
    const StageTime& stage = probe.context.profiler().stages().front();
    CHECK(stage.name == "probe_sizes");
    CHECK(stage.launches == 3);
    CHECK(stage.items == 1 + local + local + 1);
    CHECK(stage.milliseconds > 0.0);
  }
}

TEST_CASE(
    "kernels that do not compile: one line with the first error, its file and line, and the whole log in a file") {
  Context context(choose_device(""));
  const test::KernelFolder folder;
  const test::TempFolder cache;
  const test::ScopedVariable variable("HEMIRAY_CACHE_DIR", cache.path().string());
  folder.write("probe/broken.cl",
               "#include \"probe/fine.h\"\n\nkernel void probe() { int x = not_declared; }\n\nint f() { nor_this; }\n");
  folder.write("probe/fine.h", "int fine(void);\n");
  try {
    const Program program(context, "broken program", {"probe/broken.cl"}, {});
    FAIL("it compiled");
  } catch (const DeviceError& error) {
    const std::string message = error.what();
    CHECK_THAT(message, Catch::Contains("broken program"));
    CHECK_THAT(message, Catch::Contains("CL_BUILD_PROGRAM_FAILURE"));
    CHECK_THAT(message, Catch::Contains("not_declared"));
    CHECK_THAT(message, Catch::Contains("probe/broken.cl:3"));
    CHECK(message.find('\n') == std::string::npos);
    CHECK(error.code() == ExitCode::device);
    const std::string log = test::read_whole_file(cache / "broken program_build.log");
    CHECK_THAT(log, Catch::Contains("not_declared") && Catch::Contains("nor_this"));
    CHECK_THAT(message, Catch::Contains((cache / "broken program_build.log").string()));
  }
}

TEST_CASE("a cached program runs as a fresh one does, and a damaged entry is compiled anew") {
  const test::TempFolder cache;
  const test::ScopedVariable variable("HEMIRAY_CACHE_DIR", cache.path().string());
  const auto check_runs = [](bool from_cache) {
    Probe probe;
    CHECK(probe.program.from_cache() == from_cache);
    Buffer<std::uint32_t> values(probe.context, "values", 3);
    launch(probe.context, probe.program.kernel("probe_fill"), 3,
           arguments(arg("values", values), arg("base", 1U), arg("stride", 1U), arg("count", 3U)));
    CHECK(values.read() == std::vector<std::uint32_t>{1001, 1002, 1003});
  };
  check_runs(false);
  const bool own_cache = Context(choose_device("")).profile().has_own_cache;
  check_runs(!own_cache);  // a driver that caches itself is not given binaries
  std::size_t entries = 0;
  for (const auto& entry : std::filesystem::directory_iterator(cache.path())) {
    entries++;
    cache.write(entry.path().filename().string(), "hemiray program 1\nnonsense");
  }
  CHECK(entries == (own_cache ? 0 : 1));
  check_runs(false);
}

TEST_CASE("a context builds a text once for each set of options, and its programs share the kernels") {
  const test::TempFolder cache;
  const test::ScopedVariable variable("HEMIRAY_CACHE_DIR", cache.path().string());
  const test::KernelFolder folder;
  folder.write("probe/probe.cl", kProbe);
  folder.write("probe/constant.h", "#define PROBE_CONSTANT 1000\n");
  Context context(choose_device(""));
  Buffer<std::uint32_t> values(context, "values", 4);
  const auto strict_of = [&](Program& program) {
    launch(context, program.kernel("probe_sizes"), 1, arguments(arg("values", values)));
    return values.read()[3];
  };
  Program first(context, "first", {"probe/probe.cl"}, {});
  CHECK_FALSE(first.from_cache());
  CHECK(strict_of(first) == 0);
  CHECK(context.compile_ms() >= first.build_ms() + context.launch_compile_ms());
  const double launch_compile_ms = context.launch_compile_ms();
  Program second(context, "second", {"probe/probe.cl"}, {}), strict(context, "strict", {"probe/probe.cl"}, {0, true});
  CHECK(second.from_cache());
  CHECK_FALSE(strict.from_cache());
  CHECK(strict_of(second) == 0);
  CHECK(context.launch_compile_ms() == launch_compile_ms);  // launched before
  CHECK(strict_of(strict) == 1);
  CHECK(strict_of(first) == 0);
  CHECK(context.compile_ms() == first.build_ms() + second.build_ms() + strict.build_ms() + context.launch_compile_ms());
  folder.write("probe/constant.h", "#define PROBE_CONSTANT 1001\n");
  CHECK_FALSE(Program(context, "edited", {"probe/probe.cl"}, {}).from_cache());
}

TEST_CASE("the flattened text can be dumped into a folder made on the way, and a file in its place is said so") {
  const test::TempFolder dump;
  {
    const test::ScopedVariable variable("HEMIRAY_DUMP_KERNELS", dump.path().string());
    const Probe probe;
  }
  CHECK_THAT(test::read_whole_file(dump / "probe.cl"),
             Catch::StartsWith("#line 1 \"probe/probe.cl\"\n#line 1 \"probe/constant.h\"\n#define PROBE_CONSTANT"));
  {
    const test::ScopedVariable variable("HEMIRAY_DUMP_KERNELS", (dump / "new").string());
    const Probe probe;
  }
  CHECK(test::read_whole_file(dump / "new" / "probe.cl") == test::read_whole_file(dump / "probe.cl"));
  const test::ScopedVariable variable("HEMIRAY_DUMP_KERNELS", (dump / "probe.cl").string());
  CHECK_THROWS_AS(Probe(), InputError);
}

}  // namespace hemiray
