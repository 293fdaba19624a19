#include "host/radiosity/solution_key.hpp"

#include <algorithm>
#include <span>
#include <tuple>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "host/base/build_info.hpp"
#include "host/base/error.hpp"
#include "host/base/sha256.hpp"
#include "host/gpu/source_store.hpp"

namespace hemiray {
namespace {

constexpr std::size_t kLongestShown = 40;  // of a value in a message: hashes tell nobody anything

// Of everything in it: what a mesh is made from, and what lights it.
std::string scene_hash(const FlatScene& flat) {
  // A member more or less does not compile: it belongs below.
  const auto& [positions, normals, uvs, colors, triangles, triangle_objects, spheres, shapes, tapes, patch_light,
               gather_rays, planes, materials, lights, emitters, textures, texels, shared_meshes, instances] = flat;
  static_cast<void>(gather_rays);  // how a solution is shown
  Sha256 hash;
  const auto add = [&hash](const auto&... lists) {
    const auto add_list = [&hash](const auto& list) {
      const std::uint64_t count = list.size();
      hash.add({reinterpret_cast<const std::uint8_t*>(&count), sizeof count});
      hash.add({reinterpret_cast<const std::uint8_t*>(list.data()), list.size() * sizeof(list[0])});
    };
    (add_list(lists), ...);
  };
  add(positions, normals, uvs, colors, triangles, triangle_objects, spheres, shapes, tapes, patch_light, planes,
      materials, lights, emitters, textures, texels, shared_meshes, instances);
  return to_hex(hash.digest());
}

std::string kernels_hash() {
  std::string all;
  for (const EmbeddedFile& file : std::span(kEmbeddedKernels, kEmbeddedKernelCount)) {
    all += sha256(kernel_source(file.path));
  }
  return sha256(all);
}

std::string name_of(FormFactors method, CubeView view) {
  if (method == FormFactors::hemicube) return view == CubeView::raster ? "raster" : "hemicube";
  const std::string name = method == FormFactors::analytic ? "analytic" : "hybrid";
  return view == CubeView::raster ? name + ", raster" : name;
}

// By the names that the command line has for them. Of each structure all members are named, so that a new one does not
// compile before it is thought of here: those left out do not change what is computed.
nlohmann::ordered_json options_json(const RadiosityOptions& options, const DeviceInfo& device) {
  const auto& [edge_m, patches, chord_m] = options.mesh;
  const auto& [method, hemicube, visibility, precision] = options.factors;
  const auto& [view, resolution, divisions, turned, jittered, seed, batch_bytes] = hemicube;
  const auto& [search, few, many, accuracy, visibility_seed] = visibility;
  const auto& [kind, tolerance, iterations, seconds, group, shots, pick, restart, single_precision, on_iteration,
               offer_state, continue_from] = options.solve;
  static_cast<void>(std::tie(seconds, on_iteration, offer_state, continue_from));
  nlohmann::ordered_json json;
  json["--patches"] = patches;
  json["--edge"] = edge_m;
  json["--chord"] = chord_m;
  json["--form-factors"] = name_of(method, view);
  json["--resolution"] = resolution;
  json["--points"] = divisions * divisions;
  json["--cells"] = jittered ? "jittered" : (turned ? "turned" : "aligned");
  json["--seed"] = seed;
  json["seed of rays between pairs"] = visibility_seed;
  json["--factor-precision"] = to_string(precision);
  json["rows a batch"] = batch_bytes;
  json["--pair-search"] = search == PairSearch::shafts ? "shafts" : "rays";
  json["--pair-rays"] = many;
  json["rays to find partly hidden pairs"] = few;
  json["accuracy of partly hidden pairs"] = accuracy;
  json["--factor-memory"] = options.factor_bytes > 0 ? options.factor_bytes : device.global_bytes;
  json["--solver"] = to_string(kind);
  json["--tolerance"] = tolerance;
  json["--iterations"] = iterations;
  json["--shots"] = shots;
  json["--pick"] = pick == ShotPick::power ? "power" : "residual";
  json["group"] = group;
  json["restart"] = restart;
  json["single precision"] = single_precision;
  return json;
}

}  // namespace

std::string solution_key(const Context& context, const FlatScene& flat, const RadiosityOptions& options) {
  const DeviceInfo& device = context.device();
  nlohmann::ordered_json key = options_json(options, device);
  key["scene"] = scene_hash(flat);
  key["program"] = fmt::format("{} {}", kVersion, kCommit);
  key["kernels"] = kernels_hash();
  key["device"] = device.name;
  key["driver"] = {device.version, device.driver, device.platform, device.platform_version, device.parts};
  key["device profile"] = sha256(profile_json(device, context.profile()));
  return key.dump();
}

std::string difference_of_keys(const std::string& old_key, const std::string& new_key) {
  const auto was = nlohmann::ordered_json::parse(old_key, nullptr, false), is = nlohmann::ordered_json::parse(new_key);
  if (!was.is_object()) throw InputError("its head cannot be read");
  std::string text;
  for (const auto& [name, value] : is.items()) {
    const auto found = was.find(name);
    if (found != was.end() && *found == value) continue;
    const std::string before = found != was.end() ? found->dump() : "none", now = value.dump();
    text += (text.empty() ? "" : ", ") + name;
    if (std::max(before.size(), now.size()) <= kLongestShown) text += fmt::format(" ({} there, {} now)", before, now);
  }
  return text;
}

}  // namespace hemiray
