// The device profile: its classes, and the file that HEMIRAY_PROFILE names.
#include <catch2/catch.hpp>

#include <string>
#include <utility>

#include "host/base/error.hpp"
#include "host/gpu/context.hpp"
#include "host/gpu/device_profile.hpp"
#include "tests/support/profile_file.hpp"
#include "tests/support/run_program.hpp"

namespace hemiray {
namespace {

using test::ProfileFile;

DeviceInfo some_device(DeviceKind kind, const std::string& name) {
  DeviceInfo device;
  device.kind = kind;
  device.name = name;
  device.compute_units = 3;
  return device;
}

void check_refused(const std::string& text, const std::string& place, const std::string& why) {
  INFO(text);
  const ProfileFile file(text);
  const DeviceInfo device = some_device(DeviceKind::cpu, "a device");
  CHECK_THROWS_AS(profile_for(device), InputError);
  CHECK_THROWS_WITH(profile_for(device), Catch::Contains("profile.json" + place) && Catch::Contains(why) &&
                                             !Catch::Contains("json.exception"));
}

}  // namespace

TEST_CASE("the profile suits the kind of device") {
  const test::ScopedVariable none("HEMIRAY_PROFILE", std::nullopt);
  DeviceInfo device = some_device(DeviceKind::cpu, "a device");
  const DeviceProfile cpu = profile_for(device);
  CHECK(cpu.chunks == 12);
  CHECK_FALSE(cpu.has_own_cache);
  device.platform = "Portable Computing Language";
  CHECK(profile_for(device).has_own_cache);
  device.kind = DeviceKind::gpu;
  const DeviceProfile gpu = profile_for(device);
  CHECK(gpu.wave_slots > cpu.wave_slots);
  CHECK(gpu.explicit_vectors == 0);
  CHECK(cpu.explicit_vectors == 1);
  CHECK(gpu.cluster_chunks > cpu.cluster_chunks);
}

TEST_CASE("every class's profile lies in the ranges that a file may set") {
  for (const DeviceKind kind : {DeviceKind::cpu, DeviceKind::gpu, DeviceKind::other}) {
    const DeviceInfo device = some_device(kind, "a device");
    const DeviceProfile profile = class_profile(device);
    const ProfileFile file(profile_json(device, profile));  // what is written can be read
    const DeviceProfile read = profile_for(device);
#define HR_EQUAL(name, value, least, most, what) \
  CHECK(read.name == profile.name);              \
  CHECK(profile.name <= (most));
    HR_PROFILE_FIELDS(HR_EQUAL)
#undef HR_EQUAL
  }
}

TEST_CASE("every field of the profile is set by the file") {
  const DeviceInfo device = some_device(DeviceKind::cpu, "a device");
#define HR_SET_ONE(field, value, least, most, what)                                                         \
  {                                                                                                         \
    const std::uint32_t other = class_profile(device).field == (least) ? (most) : (least);                  \
    const bool is_pair = std::string(#field) == "cluster_limit"; /* may not be less than what is kept */    \
    const std::string more = is_pair ? R"(, "cluster_keep": 1)" : "";                                       \
    const std::string room = std::string(#field) == "cluster_keep" ? R"(, "cluster_limit": 64)" : "";       \
    const ProfileFile file(ProfileFile::for_all("\"" #field "\": " + std::to_string(other) + more + room)); \
    CHECK(profile_for(device).field == other);                                                              \
  }
  HR_PROFILE_FIELDS(HR_SET_ONE)
#undef HR_SET_ONE
}

TEST_CASE("an entry of the profile file counts for the devices it names, later ones over earlier ones") {
  const ProfileFile file(R"({"profiles": [{"bvh_width": 2, "max_leaf": 5},
                                          {"device": "Zen", "bvh_width": 4},
                                          {"device": "other", "bvh_width": 8, "chunks": 99}]})");
  const DeviceProfile zen = profile_for(some_device(DeviceKind::cpu, "AMD Zen 3"));
  CHECK(zen.bvh_width == 4);
  CHECK(zen.max_leaf == 5);
  CHECK(zen.chunks == 12);
  CHECK(zen.leaf_lanes == DeviceProfile{}.leaf_lanes);
  const DeviceProfile other = profile_for(some_device(DeviceKind::cpu, "another device"));
  CHECK(other.bvh_width == 8);
  CHECK(other.chunks == 99);
  const DeviceProfile neither = profile_for(some_device(DeviceKind::cpu, "a device"));
  CHECK(neither.bvh_width == 2);
  const DeviceInfo real = choose_device("");
  CHECK(Context(real).profile().max_leaf == 5);
  const test::ScopedVariable empty("HEMIRAY_PROFILE", "");  // as if it were not set
  CHECK(Context(real).profile().max_leaf == class_profile(real).max_leaf);
}

TEST_CASE("a wrong profile file is an input error that names the place") {
  const auto entry = [](const std::string& fields) { return ProfileFile::for_all(fields); };
  check_refused("", ":1:1: ", "unexpected end of input");
  check_refused("{\"profiles\": [", ":1:15: ", "unexpected end of input");
  check_refused("{\"profiles\": [}", ":1:15: ", "'hemiray tune -o FILE'");
  check_refused("[]", "", "'profiles'");
  check_refused("{}", "", "'profiles'");
  check_refused(R"({"profiles": {}})", "", "'profiles'");
  check_refused(R"({"profiles": [7]})", ": /profiles/0", "must be an object");
  check_refused(R"({"profiles": [{}, {"bvh_widht": 4}]})", ": /profiles/1", "'bvh_widht'");
  check_refused(entry(R"("device": 7)"), ": /profiles/0/device", "name");
  check_refused(entry(R"("bvh_width": 16)"), ": /profiles/0/bvh_width", "from 2 to 8");
  check_refused(entry(R"("bvh_width": 1)"), ": /profiles/0/bvh_width", "from 2 to 8");
  check_refused(entry(R"("bvh_width": 3)"), ": /profiles/0", "powers of two");
  check_refused(entry(R"("leaf_lanes": 6)"), ": /profiles/0", "powers of two");
  check_refused(entry(R"("max_leaf": 0)"), ": /profiles/0/max_leaf", "from 1 to 120");
  check_refused(entry(R"("max_leaf": -4)"), ": /profiles/0/max_leaf", "whole number");
  check_refused(entry(R"("max_leaf": 4.5)"), ": /profiles/0/max_leaf", "whole number");
  check_refused(entry(R"("max_leaf": "4")"), ": /profiles/0/max_leaf", "whole number");
  check_refused(entry(R"("max_leaf": 99999999999999999999)"), ": /profiles/0/max_leaf", "from 1 to 120");
  check_refused(entry(R"("cluster_limit": 8, "cluster_keep": 9)"), ": /profiles/0", "cluster_keep");
  check_refused(entry(R"("max_leaf": 4, "chunks": 8, "max_leaf": 8)"), ": /profiles/0: ", "\"max_leaf\" occurs twice");
  check_refused(R"({"profiles": [], "profiles": [{"max_leaf": 4}]})", ": ", "\"profiles\" occurs twice");
  // What names another device must be right too.
  check_refused(entry(R"("device": "nothing like it", "bvh_width": 5)"), ": /profiles/0", "powers of two");
}

TEST_CASE("the program stops with exit code 2 where the profile file is wrong or missing") {
  const test::TempFolder folder;
  const std::string wrong = folder.write("wrong.json", R"({"profiles": [{"max_leaf": 1000}]})").string();
  for (const auto& [file, why] : {std::pair<std::string, std::string>{wrong, "/profiles/0/max_leaf"},
                                  {(folder / "none.json").string(), "none.json"}}) {
    const test::ProgramResult result =
        test::run_program({"render", HR_SOURCE_DIR "/scenes/cornell_box.json", "-o", (folder / "x.exr").string()},
                          {{"HEMIRAY_PROFILE", file}});
    CHECK(result.exit_code == 2);
    CHECK_THAT(result.err, Catch::Contains(why));
    CHECK_FALSE(std::filesystem::exists(folder / "x.exr"));
  }
}

}  // namespace hemiray
