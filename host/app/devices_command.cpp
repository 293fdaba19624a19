// `hemiray devices`: every OpenCL device with what hemiray would use of it.
#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>

#include "host/app/commands.hpp"
#include "host/base/error.hpp"
#include "host/base/numbers.hpp"
#include "host/gpu/device_list.hpp"
#include "host/gpu/device_profile.hpp"

namespace hemiray::app {
namespace {

constexpr const char* kExamples = R"(Examples:
  hemiray devices                                     list what is there
  hemiray render SCENE -o out.exr --device 1          choose by index,
  hemiray render SCENE -o out.exr --device gpu        by kind (cpu, gpu),
  HEMIRAY_DEVICE=pocl hemiray render SCENE -o out.exr or by part of a name;
  hemiray render SCENE -o out.exr --device 0,1        share the work between several,
  hemiray render SCENE -o out.exr --device all        between all of them,
  hemiray render SCENE -o out.exr --device split:2    or between two halves of the default one)";

nlohmann::json to_json(const DeviceInfo& d, bool chosen) {
  const DeviceProfile profile = profile_for(d);
  return {{"index", d.index},
          {"default", chosen},
          {"name", d.name},
          {"platform", d.platform},
          {"vendor", d.vendor},
          {"driver", d.driver},
          {"version", d.version},
          {"kind", to_string(d.kind)},
          {"compute_units", d.compute_units},
          {"global_bytes", d.global_bytes},
          {"max_allocation_bytes", d.max_allocation_bytes},
          {"fp64", d.has_fp64},
          {"correctly_rounded_divide", d.rounds_divide_correctly},
          {"can_be_split", d.can_be_split},
          {"usable", d.usable},
          {"why_not", d.why_not},
          {"profile",
           {{"local_size", profile.local_size}, {"chunks", profile.chunks}, {"wave_slots", profile.wave_slots}}}};
}

void print(const DeviceInfo& d, bool chosen) {
  const DeviceProfile profile = profile_for(d);
  fmt::print("{} {}{}\n", d.index, d.name, chosen ? "  (default)" : "");
  fmt::print("    platform   {} ({})\n    driver     {} | {}\n", d.platform, d.platform_version, d.driver, d.version);
  fmt::print("    kind       {}, {}\n", to_string(d.kind), format_count(d.compute_units, "compute unit"));
  fmt::print("    memory     {}, at most {} in one piece\n", format_bytes(d.global_bytes),
             format_bytes(d.max_allocation_bytes));
  fmt::print("    numbers    double precision: {}; divide and square root correctly rounded: {}\n",
             d.has_fp64 ? "yes" : "no", d.rounds_divide_correctly ? "yes" : "no");
  fmt::print("    would use  work-groups of {}, {} chunks, {} paths in flight\n", profile.local_size, profile.chunks,
             profile.wave_slots);
  if (!d.usable) fmt::print("    NOT usable: {}\n", d.why_not);
}

}  // namespace

void add_devices_command(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand("devices", "List OpenCL devices and what hemiray would use of them");
  const auto json = std::make_shared<bool>(false);
  command->add_flag("--json", *json, "Print as JSON");
  command->footer(kExamples);
  command->callback([json, &exit_code] {
    const std::vector<DeviceInfo> devices = list_devices();
    // Throws, with the package to install, if there is none.
    const std::vector<DeviceInfo> defaults = choose_devices("");
    const auto is_default = [&defaults](const DeviceInfo& device) {
      return std::any_of(defaults.begin(), defaults.end(),
                         [&device](const DeviceInfo& d) { return d.index == device.index; });
    };
    nlohmann::json all = nlohmann::json::array();
    for (const DeviceInfo& device : devices) {
      if (*json) {
        all.push_back(to_json(device, is_default(device)));
      } else {
        print(device, is_default(device));
      }
    }
    if (*json) fmt::print("{}\n", all.dump(2));
    exit_code = static_cast<int>(ExitCode::ok);
  });
}

}  // namespace hemiray::app
