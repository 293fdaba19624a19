// Choosing a device: by index, kind, part of a name, environment; and what is said where none fits.
#include <catch2/catch.hpp>

#include <algorithm>
#include <cctype>
#include <string>

#include "host/base/error.hpp"
#include "host/gpu/context.hpp"
#include "host/gpu/device.hpp"
#include "tests/support/kernel_folder.hpp"
#include "tests/support/run_program.hpp"

namespace hemiray {
namespace {

std::string changed_case(std::string text) {
  for (char& c : text) {
    const auto letter = static_cast<unsigned char>(c);
    c = static_cast<char>(std::islower(letter) != 0 ? std::toupper(letter) : std::tolower(letter));
  }
  return text;
}

}  // namespace

TEST_CASE("devices are numbered in order and described") {
  const std::vector<DeviceInfo> devices = list_devices();
  REQUIRE_FALSE(devices.empty());
  for (std::size_t i = 0; i < devices.size(); i++) {
    const DeviceInfo& device = devices[i];
    CHECK(device.index == static_cast<int>(i));
    CHECK_FALSE(device.name.empty());
    CHECK(device.name.find('\0') == std::string::npos);
    CHECK(device.platform.find('\0') == std::string::npos);
    CHECK_THAT(device.version, Catch::StartsWith("OpenCL "));
    CHECK(device.compute_units > 0);
    CHECK(device.max_work_group_size > 0);
    CHECK(device.max_allocation_bytes > 0);
    CHECK(device.global_bytes >= device.max_allocation_bytes);
    CHECK(device.usable == device.why_not.empty());
  }
}

TEST_CASE("a device is chosen by index, by kind and by part of a name in any case") {
  const test::ScopedVariable none("HEMIRAY_DEVICE", std::nullopt);
  for (const DeviceInfo& device : list_devices()) {
    if (!device.usable) continue;
    CHECK(choose_device(std::to_string(device.index)).index == device.index);
    const std::string kind = to_string(device.kind);
    if (device.kind != DeviceKind::other) {
      CHECK(to_string(choose_device(kind).kind) == kind);
      CHECK(to_string(choose_device(changed_case(kind)).kind) == kind);
    }
    const std::string part = device.name.substr(1, device.name.size() - 2);
    CHECK(choose_device(part).name == device.name);
    CHECK(choose_device(changed_case(part)).name == device.name);
    CHECK(choose_device(changed_case(device.platform)).platform == device.platform);
  }
}

TEST_CASE("without a choice the first usable GPU is taken, else the first usable device") {
  const test::ScopedVariable none("HEMIRAY_DEVICE", std::nullopt);
  const std::vector<DeviceInfo> devices = list_devices();
  const auto gpu = std::find_if(devices.begin(), devices.end(),
                                [](const DeviceInfo& d) { return d.usable && d.kind == DeviceKind::gpu; });
  const auto first = std::find_if(devices.begin(), devices.end(), [](const DeviceInfo& d) { return d.usable; });
  REQUIRE(first != devices.end());
  CHECK(choose_device("").index == (gpu != devices.end() ? gpu->index : first->index));
}

TEST_CASE("HEMIRAY_DEVICE is the default, the given choice goes before it") {
  const int index = choose_device("").index;
  const test::ScopedVariable variable("HEMIRAY_DEVICE", "no such device");
  CHECK(choose_device(std::to_string(index)).index == index);
  CHECK_THROWS_WITH(choose_device(""), Catch::StartsWith("HEMIRAY_DEVICE: no device matches 'no such device'"));
}

TEST_CASE("an unknown device is an input error that lists what there is") {
  const std::vector<DeviceInfo> devices = list_devices();
  for (const std::string& selector : {std::to_string(devices.size()), std::string("-1"), std::string("nothing like it"),
                                      std::string("0x"), std::string("99999999999999999999")}) {
    INFO(selector);
    CHECK_THROWS_AS(choose_device(selector), InputError);
    CHECK_THROWS_WITH(choose_device(selector), Catch::StartsWith("--device: ") && Catch::Contains(selector) &&
                                                   Catch::Contains("0 " + devices.front().name));
  }
}

TEST_CASE("no device at all: exit code 1 and the package to install") {
  const test::TempFolder empty;
  const test::ProgramResult result =
      test::run_program({"render", HR_SOURCE_DIR "/scenes/cornell_box.json", "-o", (empty / "x.exr").string()},
                        {{"OCL_ICD_VENDORS", empty.path().string() + "/"}, {"OCL_ICD_FILENAMES", ""}});
  CHECK(result.exit_code == 1);
  CHECK_THAT(result.err, Catch::Contains("no usable OpenCL device") && Catch::Contains("pocl-opencl-icd"));
  CHECK(std::filesystem::is_empty(empty.path()));
}

TEST_CASE("the profile suits the kind of device") {
  DeviceInfo device;
  device.kind = DeviceKind::cpu;
  device.compute_units = 3;
  const DeviceProfile cpu = profile_for(device);
  CHECK(cpu.chunks == 12);
  CHECK_FALSE(cpu.has_own_cache);
  device.platform = "Portable Computing Language";
  CHECK(profile_for(device).has_own_cache);
  device.kind = DeviceKind::gpu;
  CHECK(profile_for(device).wave_slots > cpu.wave_slots);
}

}  // namespace hemiray
