#include "host/gpu/device.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cstdlib>

#include <fmt/format.h>

#include "host/base/error.hpp"
#include "host/gpu/cl_error.hpp"

namespace hemiray {
namespace {

std::string trimmed(std::string text) {
  while (!text.empty() && (std::isspace(static_cast<unsigned char>(text.back())) != 0 || text.back() == '\0')) {
    text.pop_back();
  }
  return text;
}

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
  return text;
}

DeviceInfo describe(const cl::Platform& platform, const cl::Device& device) {
  DeviceInfo info;
  info.handle = device;
  info.platform = trimmed(platform.getInfo<CL_PLATFORM_NAME>());
  info.platform_version = trimmed(platform.getInfo<CL_PLATFORM_VERSION>());
  info.name = trimmed(device.getInfo<CL_DEVICE_NAME>());
  info.vendor = trimmed(device.getInfo<CL_DEVICE_VENDOR>());
  info.driver = trimmed(device.getInfo<CL_DRIVER_VERSION>());
  info.version = trimmed(device.getInfo<CL_DEVICE_VERSION>());
  const cl_device_type type = device.getInfo<CL_DEVICE_TYPE>();
  info.kind = (type & CL_DEVICE_TYPE_GPU) != 0   ? DeviceKind::gpu
              : (type & CL_DEVICE_TYPE_CPU) != 0 ? DeviceKind::cpu
                                                 : DeviceKind::other;
  info.compute_units = device.getInfo<CL_DEVICE_MAX_COMPUTE_UNITS>();
  info.global_bytes = device.getInfo<CL_DEVICE_GLOBAL_MEM_SIZE>();
  info.max_allocation_bytes = device.getInfo<CL_DEVICE_MAX_MEM_ALLOC_SIZE>();
  info.max_work_group_size = device.getInfo<CL_DEVICE_MAX_WORK_GROUP_SIZE>();
  info.has_fp64 = device.getInfo<CL_DEVICE_DOUBLE_FP_CONFIG>() != 0;
  info.rounds_divide_correctly =
      (device.getInfo<CL_DEVICE_SINGLE_FP_CONFIG>() & CL_FP_CORRECTLY_ROUNDED_DIVIDE_SQRT) != 0;
  const std::vector<cl_device_partition_property> ways = device.getInfo<CL_DEVICE_PARTITION_PROPERTIES>();
  info.can_be_split = std::count(ways.begin(), ways.end(), CL_DEVICE_PARTITION_EQUALLY) > 0 &&
                      std::count(ways.begin(), ways.end(), CL_DEVICE_PARTITION_BY_COUNTS) > 0;
  const auto refuse = [&info](const std::string& why) {
    info.usable = false;
    if (info.why_not.empty()) info.why_not = why;
  };
  if (device.getInfo<CL_DEVICE_AVAILABLE>() == CL_FALSE) refuse("not available");
  if (device.getInfo<CL_DEVICE_COMPILER_AVAILABLE>() == CL_FALSE) refuse("no compiler");
  if (device.getInfo<CL_DEVICE_ENDIAN_LITTLE>() == CL_FALSE) refuse("not little-endian");
  if (info.version.rfind("OpenCL 1.0", 0) == 0 || info.version.rfind("OpenCL 1.1", 0) == 0) {
    refuse("older than OpenCL 1.2");
  }
  if (info.compute_units == 0) refuse("no compute unit");
  return info;
}

bool matches(const DeviceInfo& device, const std::string& selector) {
  if (selector == "cpu") return device.kind == DeviceKind::cpu;
  if (selector == "gpu") return device.kind == DeviceKind::gpu;
  for (const std::string* text : {&device.name, &device.platform, &device.platform_version}) {
    if (lower(*text).find(selector) != std::string::npos) return true;
  }
  return false;
}

// Intel's runtime for CPUs reads this when it is loaded. Its vectoriser (2026.2, AVX-512) answers implicit surfaces of
// degree 16 otherwise from run to run; program.cpp tells of lost paths. What the user has set stays.
void switch_off_vectorizer() { ::setenv("CL_CONFIG_CPU_VECTORIZER_MODE", "1", 0); }

}  // namespace

std::string to_string(DeviceKind kind) {
  return kind == DeviceKind::cpu ? "cpu" : kind == DeviceKind::gpu ? "gpu" : "other";
}

std::string names_of(const std::vector<DeviceInfo>& devices) {
  std::string names;
  for (const DeviceInfo& device : devices) {
    names += fmt::format("{}{} {} ({})", names.empty() ? "" : "; ", device.index, device.name, device.platform);
  }
  return names;
}

std::vector<DeviceInfo> list_devices() {
  std::vector<DeviceInfo> devices;
  std::vector<cl::Platform> platforms;
  switch_off_vectorizer();
  try {
    cl::Platform::get(&platforms);
  } catch (const cl::Error&) {
    return devices;  // CL_PLATFORM_NOT_FOUND_KHR: none installed
  }
  for (const cl::Platform& platform : platforms) {
    std::vector<cl::Device> handles;
    try {
      cl::Platform(platform).getDevices(CL_DEVICE_TYPE_ALL, &handles);
    } catch (const cl::Error&) {
      continue;  // a platform without devices, or a broken one
    }
    for (const cl::Device& handle : handles) {
      try {
        DeviceInfo info = describe(platform, handle);
        info.index = static_cast<int>(devices.size());
        devices.push_back(std::move(info));
      } catch (const cl::Error&) {
        continue;  // a device that cannot describe itself cannot be used
      }
    }
  }
  return devices;
}

DeviceInfo choose_device(const std::string& selector) {
  const char* environment = selector.empty() ? std::getenv("HEMIRAY_DEVICE") : nullptr;
  return environment != nullptr ? choose_device(environment, "HEMIRAY_DEVICE") : choose_device(selector, "--device");
}

DeviceInfo choose_device(const std::string& selector_given, const std::string& place) {
  const std::string selector = lower(selector_given);
  const std::vector<DeviceInfo> devices = list_devices();
  if (std::none_of(devices.begin(), devices.end(), [](const DeviceInfo& d) { return d.usable; })) {
    throw DeviceError(
        "no usable OpenCL device found: install a driver, for instance Debian's pocl-opencl-icd for the CPU "
        "(apt-get install pocl-opencl-icd), and see what is there with 'hemiray devices'");
  }
  if (selector.empty()) {
    const auto gpu = std::find_if(devices.begin(), devices.end(),
                                  [](const DeviceInfo& d) { return d.usable && d.kind == DeviceKind::gpu; });
    if (gpu != devices.end()) return *gpu;
    return *std::find_if(devices.begin(), devices.end(), [](const DeviceInfo& d) { return d.usable; });
  }
  int index = 0;
  const auto [end, error] = std::from_chars(selector.data(), selector.data() + selector.size(), index);
  if (error == std::errc{} && end == selector.data() + selector.size()) {
    if (index < 0 || index >= static_cast<int>(devices.size())) {
      throw InputError(place, fmt::format("there is no device {}; there are: {}", index, names_of(devices)));
    }
    const DeviceInfo& device = devices[static_cast<std::size_t>(index)];
    if (!device.usable) throw DeviceError(fmt::format("device {} cannot be used: {}", index, device.why_not));
    return device;
  }
  std::string refused;
  for (const DeviceInfo& device : devices) {
    if (!matches(device, selector)) continue;
    if (device.usable) return device;
    refused = device.why_not;
  }
  if (!refused.empty()) throw DeviceError(fmt::format("device '{}' cannot be used: {}", selector, refused));
  throw InputError(place, fmt::format("no device matches '{}'; there are: {}", selector, names_of(devices)));
}

}  // namespace hemiray
