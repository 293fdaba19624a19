// Kernel sources: the embedded table, overriding from a folder, flattening.
#include <catch2/catch.hpp>

#include <filesystem>
#include <set>
#include <string>

#include "host/base/error.hpp"
#include "host/gpu/source_store.hpp"
#include "tests/support/kernel_folder.hpp"

namespace hemiray {
namespace {

std::string embedded_text(const EmbeddedFile& file) { return {reinterpret_cast<const char*>(file.bytes), file.size}; }

std::size_t occurrences(const std::string& text, const std::string& part) {
  std::size_t count = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) count++;
  return count;
}

}  // namespace

TEST_CASE("the program carries every kernel source, byte for byte") {
  const std::filesystem::path folder = std::filesystem::path(HR_SOURCE_DIR) / "kernels";
  std::set<std::string> on_disk;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file()) on_disk.insert(entry.path().lexically_relative(folder).string());
  }
  std::set<std::string> embedded;
  for (std::size_t i = 0; i < kEmbeddedKernelCount; i++) {
    const EmbeddedFile& file = kEmbeddedKernels[i];
    INFO(file.path);
    CHECK(embedded_text(file) == test::read_whole_file(folder / file.path));
    embedded.insert(file.path);
  }
  CHECK(embedded == on_disk);
}

TEST_CASE("flattening expands every include once and says where each line comes from") {
  const test::KernelFolder folder;
  folder.write("a.cl", "#include \"x/b.h\"\nint a;\n  #  include  \"x/b.h\"  // again\nint c;\n");
  folder.write("x/b.h", "int b;\n#include \"d.h\"\n// \"not/an/include.h\"\n#define INCLUDE \"quoted\"\n");
  folder.write("d.h", "int d;");  // no newline at the end
  folder.write("e.cl", "#include \"d.h\"\n#include \"x/b.h\"\nint e;\n");
  CHECK(flatten_kernels({"a.cl", "e.cl"}) ==
        "#line 1 \"a.cl\"\n#line 1 \"x/b.h\"\nint b;\n#line 1 \"d.h\"\nint d;\n#line 3 \"x/b.h\"\n"
        "// \"not/an/include.h\"\n#define INCLUDE \"quoted\"\n#line 2 \"a.cl\"\nint a;\n#line 4 \"a.cl\"\nint c;\n"
        "#line 1 \"e.cl\"\n#line 2 \"e.cl\"\n#line 3 \"e.cl\"\nint e;\n");
}

TEST_CASE("a log that counts the lines of the flattened text is told in files and their lines") {
  const test::KernelFolder folder("a.cl", "#include \"x/b.h\"\nint a;\n");
  folder.write("x/b.h", "int b;\n");
  const std::string text = "// before all files\n" + flatten_kernels({"a.cl"});
  CHECK(name_sources("<kernel>:4:5: error: one\n<kernel>:6:1: two", text) == "x/b.h:1:5: error: one\na.cl:2:1: two");
  CHECK(name_sources("a.cl:2:1: as it is", text) == "a.cl:2:1: as it is");
  CHECK(name_sources("<kernel>:1:1 <kernel>:99:1 <kernel>:0:1", text) == "<kernel>:1:1 <kernel>:99:1 <kernel>:0:1");
}

TEST_CASE("files that include each other end") {
  const test::KernelFolder folder;
  folder.write("a.h", "#include \"b.h\"\nint a;\n");
  folder.write("b.h", "#include \"a.h\"\n#include \"b.h\"\nint b;\n");
  const std::string text = flatten_kernels({"a.h"});
  CHECK(occurrences(text, "int a;") == 1);
  CHECK(occurrences(text, "int b;") == 1);
}

TEST_CASE("a .def file is expanded each time it is included, but not within itself") {
  const test::KernelFolder folder;
  folder.write("a.h", "#include \"t.def\"\n#include \"t.def\"\n");
  folder.write("t.def", "int T;\n#include \"t.def\"\n#include \"u.def\"\n");
  folder.write("u.def", "int U;\n");
  const std::string text = flatten_kernels({"a.h"});
  CHECK(occurrences(text, "int T;") == 2);
  CHECK(occurrences(text, "int U;") == 2);
}

TEST_CASE("a missing kernel source is named") {
  CHECK_THROWS_AS(kernel_source("lib/nowhere.h"), InputError);
  CHECK_THROWS_WITH(kernel_source("lib/nowhere.h"), Catch::Contains("kernels/lib/nowhere.h"));
  const test::KernelFolder folder("a.cl", "#include \"gone.h\"\n");
  CHECK_THROWS_WITH(flatten_kernels({"a.cl"}), Catch::Contains("kernels/gone.h"));
}

TEST_CASE("HEMIRAY_KERNEL_DIR overrides file by file") {
  const test::ScopedVariable none("HEMIRAY_KERNEL_DIR", std::nullopt);
  const std::string rng = kernel_source("lib/rng.h");
  const std::string scan = flatten_kernels({"parallel/scan.cl"});
  REQUIRE(occurrences(rng, "rng_hash") > 0);
  {
    const test::KernelFolder folder("lib/rng.h", "int mine;\n");
    CHECK(kernel_source("lib/rng.h") == "int mine;\n");
    CHECK(flatten_kernels({"parallel/scan.cl"}) == scan);
    const std::string text = flatten_kernels({"path/megakernel.cl"});
    CHECK(occurrences(text, "#line 1 \"lib/rng.h\"\nint mine;\n") == 1);
    CHECK(occurrences(text, "stage_generate(const PathContext") == 1);
  }
  CHECK(kernel_source("lib/rng.h") == rng);
}

TEST_CASE("no include is left in any flattened kernel") {
  for (std::size_t i = 0; i < kEmbeddedKernelCount; i++) {
    const std::string path = kEmbeddedKernels[i].path;
    INFO(path);
    const std::string text = flatten_kernels({path});
    CHECK(occurrences(text, "#include \"") == 0);
    CHECK(text.rfind("#line 1 \"" + path + "\"\n", 0) == 0);
  }
}

}  // namespace hemiray
