#include "host/gpu/device_list.hpp"

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <sstream>

#include <fmt/format.h>

#include "host/base/error.hpp"
#include "host/base/numbers.hpp"
#include "host/gpu/cl_error.hpp"

namespace hemiray {
namespace {

constexpr std::string_view kSplit = "split:";

bool is_split(const std::string& selector) { return selector.rfind(kSplit, 0) == 0; }

std::vector<std::string> entries_of(const std::string& list) {
  std::vector<std::string> entries;
  std::string entry;
  for (std::istringstream text(list); std::getline(text, entry, ',');) {
    const std::size_t first = entry.find_first_not_of(' ');
    entries.push_back(first == std::string::npos ? "" : entry.substr(first, entry.find_last_not_of(' ') + 1 - first));
  }
  if (!list.empty() && list.back() == ',') entries.emplace_back();
  return entries;
}

// Names may hold commas themselves.
bool is_one_name(const std::string& selector) {
  const std::vector<DeviceInfo> devices = list_devices();
  return std::any_of(devices.begin(), devices.end(), [&selector](const DeviceInfo& d) { return d.name == selector; });
}

// Or parts of one.
bool means_several(const std::string& selector) {
  return is_split(selector) || selector == "all" || (selector.find(',') != std::string::npos && !is_one_name(selector));
}

// What is split where nothing says which: the environment's device if it names a single one.
DeviceInfo device_to_split() {
  const char* environment = std::getenv("HEMIRAY_DEVICE");
  const std::string text = environment != nullptr ? environment : "";
  if (text.empty()) return choose_device("", "--device");
  return means_several(text) ? choose_device("", "--device") : choose_device(text, "HEMIRAY_DEVICE");
}

std::vector<DeviceInfo> devices_of_entry(const std::string& entry, const std::string& place) {
  if (!is_split(entry)) return {choose_device(entry, place)};
  const std::string number = entry.substr(kSplit.size());
  int parts = 0;
  const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), parts);
  if (error != std::errc{} || end != number.data() + number.size() || parts < 1) {
    throw InputError(place, fmt::format("'{}' is not split:N with a number of sub-devices, such as split:2", entry));
  }
  return split_device(device_to_split(), parts, place);
}

std::vector<DeviceInfo> every_usable_device() {
  std::vector<DeviceInfo> devices = list_devices();
  devices.erase(std::remove_if(devices.begin(), devices.end(), [](const DeviceInfo& d) { return !d.usable; }),
                devices.end());
  if (devices.empty()) devices.push_back(choose_device("", "--device"));  // throws, naming the package to install
  return devices;
}

struct Selector {
  std::string text, place;
};

Selector given_or_environment(const std::string& given) {
  const char* environment = given.empty() ? std::getenv("HEMIRAY_DEVICE") : nullptr;
  return environment != nullptr ? Selector{environment, "HEMIRAY_DEVICE"} : Selector{given, "--device"};
}

}  // namespace

std::string label_of(const DeviceInfo& device) {
  return device.part == 0 ? device.name : fmt::format("{}, part {} of {}", device.name, device.part, device.parts);
}

std::vector<DeviceInfo> split_device(const DeviceInfo& device, int parts, const std::string& place) {
  if (parts == 1) return {device};
  const auto units = static_cast<int>(device.compute_units);
  if (parts > units) {
    throw InputError(place, fmt::format("device {} {} has {}: it cannot be split into {}", device.index, device.name,
                                        format_count(device.compute_units, "compute unit"), parts));
  }
  if (!device.can_be_split) {
    throw InputError(place, fmt::format("device {} {} cannot be split into {}: its driver offers no sub-devices (those "
                                        "of CPUs do)",
                                        device.index, device.name, parts));
  }
  std::vector<cl_device_partition_property> properties{CL_DEVICE_PARTITION_EQUALLY, units / parts, 0};
  if (units % parts != 0) {
    properties = {CL_DEVICE_PARTITION_BY_COUNTS};
    for (int i = 0; i < parts; i++) properties.push_back(units / parts + (i < units % parts ? 1 : 0));
    properties.insert(properties.end(), {CL_DEVICE_PARTITION_BY_COUNTS_LIST_END, 0});
  }
  std::vector<cl::Device> handles;
  try {
    cl::Device(device.handle).createSubDevices(properties.data(), &handles);
  } catch (const cl::Error& error) {
    throw InputError(place, fmt::format("device {} {} cannot be split into {}: {}", device.index, device.name, parts,
                                        describe_cl_error(error.err())));
  }
  std::vector<DeviceInfo> split(handles.size(), device);
  for (std::size_t i = 0; i < split.size(); i++) {
    split[i].handle = handles[i];
    split[i].compute_units = handles[i].getInfo<CL_DEVICE_MAX_COMPUTE_UNITS>();
    split[i].part = static_cast<int>(i) + 1;
    split[i].parts = static_cast<int>(split.size());
  }
  return split;
}

std::vector<DeviceInfo> choose_devices(const std::string& selector_given) {
  const auto [selector, place] = given_or_environment(selector_given);
  if (selector.empty()) return {choose_device("", "--device")};
  if (selector == "all") return every_usable_device();
  if (selector.find(',') == std::string::npos || is_one_name(selector)) return devices_of_entry(selector, place);
  std::vector<DeviceInfo> devices;
  for (const std::string& entry : entries_of(selector)) {
    if (entry.empty()) throw InputError(place, fmt::format("'{}' names no device between two commas", selector));
    if (entry == "all") throw InputError(place, fmt::format("'{}': 'all' stands alone", selector));
    std::vector<DeviceInfo> more = devices_of_entry(entry, place);
    for (const DeviceInfo& device : devices) {
      if (device.index != more.front().index) continue;
      throw InputError(place, fmt::format("'{}' names device {} {} twice", selector, device.index, device.name));
    }
    devices.insert(devices.end(), more.begin(), more.end());
  }
  return devices;
}

DeviceInfo choose_single_device(const std::string& selector_given, const std::string& who) {
  const auto [selector, place] = given_or_environment(selector_given);
  if (means_several(selector)) {
    throw InputError(place, fmt::format("'{}': {} one device; give an index or a part of a name: {}", selector, who,
                                        names_of(list_devices())));
  }
  return choose_device(selector, place);
}

}  // namespace hemiray
