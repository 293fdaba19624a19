// Which devices a user means where several may share the work; a device split into sub-devices.
#pragma once

#include <string>
#include <vector>

#include "host/gpu/device.hpp"

namespace hemiray {

/// The devices a user means by `selector`, in the order given: "all" (every usable device), "split:N" (N sub-devices of
/// the default device), anything choose_device() takes, or a list of these with commas ("0,1", "cpu,gpu"). "" is
/// HEMIRAY_DEVICE, which may hold any of these, else choose_device()'s default. Throws DeviceError if there is no
/// usable device at all, InputError for what matches nothing, for an empty place in a list and for a device named
/// twice.
std::vector<DeviceInfo> choose_devices(const std::string& selector);

/// The device a user means where only one can be used; "" as above. `who` does so, for errors ("bench measures").
/// Throws as choose_devices(), and InputError for a selector that means several or parts.
DeviceInfo choose_single_device(const std::string& selector, const std::string& who);

/// `parts` sub-devices of `device`, compute units shared out as evenly as they go; 1: the device itself. Errors name
/// `place` ("--device"). Throws InputError if it has fewer compute units, or its driver cannot split it.
std::vector<DeviceInfo> split_device(const DeviceInfo& device, int parts, const std::string& place);

/// "NAME", or "NAME, part 1 of 2" for a sub-device.
std::string label_of(const DeviceInfo& device);

}  // namespace hemiray
