// Choosing a device: by index, kind, part of a name, environment; and what is said where none fits.
#include <catch2/catch.hpp>

#include <algorithm>
#include <cctype>
#include <string>

#include "host/base/error.hpp"
#include "host/gpu/buffer.hpp"
#include "host/gpu/context.hpp"
#include "host/gpu/device.hpp"
#include "host/gpu/device_list.hpp"
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

TEST_CASE("devices are chosen by lists, all at once, or as parts of one") {
  const test::ScopedVariable none("HEMIRAY_DEVICE", std::nullopt);
  const std::vector<DeviceInfo> devices = list_devices();
  std::vector<int> usable;
  std::string list;
  for (const DeviceInfo& device : devices) {
    if (!device.usable) continue;
    usable.insert(usable.begin(), device.index);
    list = std::to_string(device.index) + (list.empty() ? "" : " , ") + list;  // backwards, with blanks
  }
  const auto indices = [](const std::vector<DeviceInfo>& chosen) {
    std::vector<int> all;
    for (const DeviceInfo& device : chosen) all.push_back(device.index);
    return all;
  };
  CHECK(indices(choose_devices(list)) == usable);
  std::vector<int> forwards(usable.rbegin(), usable.rend());
  CHECK(indices(choose_devices("all")) == forwards);
  CHECK(indices(choose_devices("")) == std::vector<int>{choose_device("").index});
  for (const DeviceInfo& device : devices) {
    if (!device.usable) continue;
    CHECK(indices(choose_devices(std::to_string(device.index))) == std::vector<int>{device.index});
    CHECK(choose_devices(device.name).front().name == device.name);
    CHECK(choose_devices(device.name).front().part == 0);
    CHECK(label_of(device) == device.name);
  }
  const test::ScopedVariable variable("HEMIRAY_DEVICE", list);
  CHECK(indices(choose_devices("")) == usable);
}

TEST_CASE("a wrong list of devices is an input error that names the wrong part") {
  const test::ScopedVariable none("HEMIRAY_DEVICE", std::nullopt);
  const DeviceInfo device = choose_device("");
  const std::string index = std::to_string(device.index);
  const auto check_wrong = [](const std::string& selector, const std::string& part) {
    INFO(selector);
    CHECK_THROWS_AS(choose_devices(selector), InputError);
    CHECK_THROWS_WITH(choose_devices(selector), Catch::StartsWith("--device: ") && Catch::Contains(part));
  };
  check_wrong(index + ",no such device", "'no such device'");
  check_wrong(index + ",99", "no device 99");
  check_wrong(index + "," + index, "device " + index + " " + device.name + " twice");
  check_wrong(index + "," + to_string(device.kind), "twice");  // by another name
  check_wrong(index + ",", "between two commas");
  check_wrong("," + index, "between two commas");
  check_wrong(index + ",all", "'all' stands alone");
  check_wrong("split:", "'split:'");
  check_wrong("split:0", "'split:0'");
  check_wrong("split:-2", "'split:-2'");
  check_wrong("split:2x", "'split:2x'");
  check_wrong("split:1000000", device.name + " has " + std::to_string(device.compute_units) + " compute unit");
  check_wrong("split:1," + index, "twice");
  const test::ScopedVariable variable("HEMIRAY_DEVICE", "99," + index);
  CHECK_THROWS_WITH(choose_devices(""), Catch::StartsWith("HEMIRAY_DEVICE: there is no device 99"));
  CHECK_NOTHROW(choose_devices(index));
}

TEST_CASE("a split device is as many parts that share its compute units") {
  const DeviceInfo whole = choose_device("");
  CHECK(split_device(whole, 1, "--device").front().part == 0);
  if (whole.compute_units < 2) {
    WARN("one compute unit only: not tested");
    return;
  }
  DeviceInfo undivided = whole;
  undivided.can_be_split = false;
  CHECK_THROWS_WITH(split_device(undivided, 2, "--device"), Catch::Contains("offers no sub-devices"));
  if (!whole.can_be_split) {
    WARN("the driver cannot split the device: not tested");
    return;
  }
  for (int parts = 2; parts <= std::min<int>(static_cast<int>(whole.compute_units), 5); parts++) {
    const std::vector<DeviceInfo> split = choose_devices("split:" + std::to_string(parts));
    CAPTURE(parts);
    REQUIRE(split.size() == static_cast<std::size_t>(parts));
    std::uint64_t units = 0, most = 0;
    for (std::size_t i = 0; i < split.size(); i++) {
      const DeviceInfo& part = split[i];
      CHECK(part.index == whole.index);
      CHECK(part.name == whole.name);  // the key of cached programs
      CHECK(part.part == static_cast<int>(i) + 1);
      CHECK(label_of(part) == whole.name + ", part " + std::to_string(i + 1) + " of " + std::to_string(parts));
      units += part.compute_units;
      most = std::max(most, part.compute_units);
      for (const DeviceInfo& other : split) CHECK((&other == &part || other.handle() != part.handle()));
      Context context(part);
      const std::vector<std::uint32_t> data{1, 2, 3};
      CHECK(Buffer<std::uint32_t>(context, "probe", data).read() == data);
    }
    CHECK(units == whole.compute_units);
    CHECK(most - whole.compute_units / split.size() <= 1);
  }
}

}  // namespace hemiray
