// Files of sections: what was written comes back; whatever is changed, cut or moved in them is noticed.
#include <catch2/catch.hpp>

#include "host/base/archive.hpp"
#include "host/base/section_file.hpp"
#include "tests/app/small_scenes.hpp"
#include "tests/support/temp_folder.hpp"

using namespace hemiray;
using namespace hemiray::test;

namespace {

constexpr SectionFileKind kKind{"thing", 3};

using Sections = std::vector<std::pair<std::string, std::vector<std::uint8_t>>>;

const Sections kSections = {{"one", {1, 2, 3}}, {"empty", {}}, {"two", {4, 5, 6, 7}}, {"two", {8, 9, 10, 11}}};

std::string written(const TempFolder& folder, const Sections& sections = kSections) {
  const std::filesystem::path file = folder / "a.thing";
  SectionWriter writer(file, kKind);
  for (const auto& [name, bytes] : sections) writer.add(name, bytes);
  writer.commit();
  return read_whole_file(file);
}

Sections read_all(const std::filesystem::path& file, SectionFileKind kind = kKind) {
  SectionReader reader(file, kind);
  Sections sections;
  for (;;) {
    SectionReader::Section section = reader.next();
    if (section.name == "end") return sections;
    sections.emplace_back(section.name, section.bytes);
  }
}

}  // namespace

TEST_CASE("sections come back as they were written") {
  const TempFolder folder;
  written(folder);
  CHECK(read_all(folder / "a.thing") == kSections);
}

TEST_CASE("no bit of a section file can be turned, no byte be missing or added, unnoticed") {
  const TempFolder folder;
  const std::string whole = written(folder);
  for (std::size_t i = 0; i < whole.size(); i++) {
    std::string damaged = whole;
    damaged[i] = static_cast<char>(damaged[i] ^ (1 << (i % 8)));
    CAPTURE(i);
    CHECK_THROWS_AS(read_all(folder.write("b", damaged)), InputError);
    CHECK_THROWS_AS(read_all(folder.write("b", whole.substr(0, i))), InputError);
  }
  CHECK_THROWS_WITH(read_all(folder.write("b", whole + "x")), Catch::Contains("behind its end"));
}

TEST_CASE("sections cannot be swapped or left out, each whole in itself") {
  const TempFolder folder;
  const std::string whole = written(folder);
  const std::size_t line = whole.find('\n') + 1, length = 8 + 8 + 4 + 32;
  const std::size_t first = whole.size() - (8 + 8 + 32) - 2 * length;
  const std::string a = whole.substr(first, length), b = whole.substr(first + length, length),
                    end = whole.substr(first + 2 * length);
  REQUIRE(line < first);
  CHECK_THROWS_AS(read_all(folder.write("b", whole.substr(0, first) + b + a + end)), InputError);
  CHECK_THROWS_AS(read_all(folder.write("b", whole.substr(0, first) + a + end)), InputError);
}

TEST_CASE("a section file of another kind or version, or none, is refused by name") {
  const TempFolder folder;
  written(folder);
  CHECK_THROWS_WITH(read_all(folder / "a.thing", {"thing", 4}),
                    Catch::Contains("has version 3") && Catch::Contains("reads version 4"));
  CHECK_THROWS_WITH(read_all(folder / "a.thing", {"other", 3}), Catch::Contains("is no other"));
  CHECK_THROWS_WITH(read_all(folder / "none"), Catch::Contains("No such file"));
  CHECK_THROWS_WITH(read_all(folder.path()), Catch::Contains("directory"));
}

TEST_CASE("a section file that is not committed leaves the old one and nothing else") {
  const TempFolder folder;
  const std::string whole = written(folder);
  { SectionWriter(folder / "a.thing", kKind).add("one", {}); }
  CHECK(read_whole_file(folder / "a.thing") == whole);
  CHECK(listing(folder.path()) == std::set<std::string>{"a.thing"});
}

TEST_CASE("an archive reads what it wrote, and no more") {
  Archive writer;
  double number = 0.25;
  std::vector<std::uint32_t> list = {7, 8, 9};
  writer.value(number);
  writer.list(list);
  const std::vector<std::uint8_t> bytes = writer.take();
  number = 0.0;
  list.clear();
  Archive reader(bytes);
  reader.value(number);
  CHECK_THROWS_AS(reader.end(), InputError);
  reader.list(list);
  reader.end();
  CHECK(number == 0.25);
  CHECK(list == std::vector<std::uint32_t>{7, 8, 9});
  Archive cut({bytes.data(), bytes.size() - 1});
  cut.value(number);
  CHECK_THROWS_AS(cut.list(list), InputError);
}
