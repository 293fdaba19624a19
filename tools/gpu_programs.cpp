// For tools/gpu_codegen.sh: writes every kernel file of HEMIRAY_KERNEL_DIR, flattened by the code that hemiray itself
// uses, into a folder, and prints the options that a GPU's profile compiles them with. Opens no device.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <fstream>
#include <string>

#include "host/base/error.hpp"
#include "host/bvh/accel_config.hpp"
#include "host/gpu/device_profile.hpp"
#include "host/gpu/source_store.hpp"
#include "shared/features.h"

namespace hemiray {

// Nothing is embedded here: all sources come from the folder.
const EmbeddedFile kEmbeddedKernels[] = {{"", nullptr, 0}};
const std::size_t kEmbeddedKernelCount = 0;

namespace {

// All features but implicit surfaces, whose solver needs more registers than there are: docs/devices.md.
std::string gpu_options() {
  DeviceInfo device;
  device.kind = DeviceKind::gpu;
  device.compute_units = 1;
  const DeviceProfile profile = class_profile(device);
  const AccelOptions tree = complete_options(AccelOptions{}, profile);
  AccelConfig config;
  config.width = tree.width;
  config.leaf_lanes = tree.leaf_lanes;
  config.explicit_vectors = tree.explicit_vectors != 0;
  return config.defines() + " -DHR_LOCAL_SIZE=" + std::to_string(profile.local_size) +
         " -DHR_FEATURES=" + std::to_string(((1U << HR_FEATURE_COUNT) - 1) & ~HR_FEATURE_IMPLICITS) + "u";
}

void write_flattened(const std::filesystem::path& kernels, const std::filesystem::path& folder) {
  for (const auto& entry : std::filesystem::recursive_directory_iterator(kernels)) {
    if (entry.path().extension() != ".cl") continue;
    const std::string path = entry.path().lexically_relative(kernels).generic_string();
    std::string name = path;
    std::replace(name.begin(), name.end(), '/', '.');  // bvh/morton.cl -> bvh.morton.cl
    std::ofstream file(folder / name, std::ios::binary);
    if (!(file << flatten_kernels({path})).flush()) throw InputError((folder / name).string(), "cannot be written");
  }
}

}  // namespace
}  // namespace hemiray

int main(int argc, char** argv) {
  const char* kernels = std::getenv("HEMIRAY_KERNEL_DIR");
  if (argc != 2 || kernels == nullptr) {
    std::fputs("usage: HEMIRAY_KERNEL_DIR=kernels gpu_programs FOLDER\n", stderr);
    return 2;
  }
  try {
    hemiray::write_flattened(kernels, argv[1]);
    std::puts(hemiray::gpu_options().c_str());
  } catch (const std::exception& error) {
    std::fprintf(stderr, "gpu_programs: %s\n", error.what());
    return 1;
  }
  return 0;
}
