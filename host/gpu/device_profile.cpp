#include "host/gpu/device_profile.hpp"

#include <bit>
#include <cstdlib>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "host/base/error.hpp"
#include "host/base/json_text.hpp"
#include "host/base/read_file.hpp"

namespace hemiray {
namespace {

using nlohmann::json;

constexpr int kMaxNesting = 8;

void set_field(DeviceProfile& profile, const std::string& key, const json& value, const std::string& place) {
  const auto set = [&](std::uint32_t& field, std::uint32_t least, std::uint32_t most) {
    if (!value.is_number_unsigned() || value.get<std::uint64_t>() < least || value.get<std::uint64_t>() > most) {
      throw InputError(place + json_pointer_step(key),
                       fmt::format("must be a whole number from {} to {}", least, most));
    }
    field = value.get<std::uint32_t>();
  };
#define HR_SET(name, value, least, most, what) \
  if (key == #name) return set(profile.name, least, most);
  HR_PROFILE_FIELDS(HR_SET)
#undef HR_SET
  throw InputError(place, fmt::format("'{}' is not a number of the device profile", key));
}

void check_powers(const DeviceProfile& profile, const std::string& place) {
  if (!std::has_single_bit(profile.bvh_width) || !std::has_single_bit(profile.leaf_lanes)) {
    throw InputError(place, "bvh_width and leaf_lanes must be powers of two");
  }
  if (profile.cluster_keep > profile.cluster_limit) throw InputError(place, "cluster_keep exceeds cluster_limit");
}

json parse_file(const std::string& file) {
  const std::vector<std::uint8_t> bytes = read_file(file);
  try {
    return parse_json_text({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, file, kMaxNesting);
  } catch (const InputError& error) {
    throw InputError(fmt::format(
        "{}; correct the file that HEMIRAY_PROFILE names, or write one with 'hemiray tune -o FILE'", error.what()));
  }
}

void apply_file(DeviceProfile& profile, const DeviceInfo& device, const std::string& file) {
  const json document = parse_file(file);
  if (!document.is_object() || !document.contains("profiles") || !document.at("profiles").is_array()) {
    throw InputError(file, "must be an object with a list 'profiles'; 'hemiray tune' writes one");
  }
  std::size_t index = 0;
  for (const json& entry : document.at("profiles")) {
    const std::string place = fmt::format("{}: /profiles/{}", file, index++);
    if (!entry.is_object()) throw InputError(place, "must be an object");
    DeviceProfile changed = profile;
    bool matches = true;
    for (const auto& [key, value] : entry.items()) {
      if (key != "device") {
        set_field(changed, key, value, place);
        continue;
      }
      if (!value.is_string()) throw InputError(place + "/device", "must be a part of a device's name");
      matches = device.name.find(value.get<std::string>()) != std::string::npos;
    }
    check_powers(changed, place);
    if (matches) profile = changed;
  }
}

}  // namespace

DeviceProfile class_profile(const DeviceInfo& device) {
  DeviceProfile profile;
  profile.has_own_cache = device.platform == "Portable Computing Language";
  if (device.kind == DeviceKind::gpu) {
    profile.chunks = 2048;
    profile.chunk_local_size = 32;
    profile.sort_groups = 512;
    profile.queue_chunks = 2048;
    profile.wave_slots = 1U << 20U;
    profile.bvh_width = 4;
    profile.leaf_lanes = 4;
    profile.max_leaf = 4;
    profile.explicit_vectors = 0;
    profile.cluster_chunks = 512;
    profile.cluster_limit = 16;
    profile.cluster_keep = 8;
    profile.top_nodes = 1024;
    profile.collapse_regions = 2048;
  } else {
    profile.chunks = static_cast<std::uint32_t>(device.compute_units) * 4;
    profile.queue_chunks = profile.chunks;
    profile.cluster_chunks = profile.chunks;
    // Work-items go one after another: a round regroups no lanes, it only costs launches and memory traffic.
    profile.tail_paths = profile.wave_slots;
  }
  return profile;
}

DeviceProfile profile_for(const DeviceInfo& device) {
  DeviceProfile profile = class_profile(device);
  const char* file = std::getenv("HEMIRAY_PROFILE");
  if (file != nullptr && *file != '\0') apply_file(profile, device, file);
  return profile;
}

std::string profile_json(const DeviceInfo& device, const DeviceProfile& profile) {
  json entry = {{"device", device.name}};
#define HR_PUT(name, value, least, most, what) entry[#name] = profile.name;
  HR_PROFILE_FIELDS(HR_PUT)
#undef HR_PUT
  return json{{"profiles", json::array({entry})}}.dump(2) + "\n";
}

}  // namespace hemiray
