// Which OpenCL devices there are, and which one a user means.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "host/gpu/opencl.hpp"

namespace hemiray {

enum class DeviceKind { cpu, gpu, other };

/// One device with what hemiray would use of it. `index` counts over all platforms in the order OpenCL lists them.
struct DeviceInfo {
  int index = 0;
  std::string platform;
  std::string platform_version;
  std::string name;
  std::string vendor;
  std::string driver;
  std::string version;  ///< "OpenCL 3.0 PoCL HSTR: ..."
  DeviceKind kind = DeviceKind::other;
  std::uint64_t compute_units = 0;
  std::uint64_t global_bytes = 0;
  std::uint64_t max_allocation_bytes = 0;
  std::uint64_t max_work_group_size = 0;
  bool has_fp64 = false;
  bool rounds_divide_correctly = false;  ///< single precision divide and square root
  bool can_be_split = false;             ///< into sub-devices; drivers of GPUs seldom offer it
  bool usable = true;
  std::string why_not;  ///< where not usable
  int part = 0;         ///< 1, 2, ...: this sub-device of device `index`; 0: the whole device
  int parts = 1;        ///< sub-devices in all
  cl::Device handle;
};

/// Every device of every platform; a platform that answers with an error or has no device is passed over.
std::vector<DeviceInfo> list_devices();

/// The device a user means by `selector`: "" (the environment's HEMIRAY_DEVICE, else the first usable GPU, else the
/// first usable device), an index, "cpu", "gpu", or part of a name (device, platform or its version;
/// case does not matter).
/// Throws DeviceError if there is no usable device at all (naming the package to install), InputError if none matches.
DeviceInfo choose_device(const std::string& selector);

/// The same for a selector that is not from the environment; errors name `place` ("--device").
DeviceInfo choose_device(const std::string& selector, const std::string& place);

/// "0 pthread-haswell (Portable Computing Language); 1 ...": how messages list devices.
std::string names_of(const std::vector<DeviceInfo>& devices);

std::string to_string(DeviceKind kind);

}  // namespace hemiray
