#include "host/radiosity/export_glb.hpp"

#include <algorithm>
#include <bit>
#include <cstring>
#include <limits>
#include <numbers>

#include <nlohmann/json.hpp>

#include "host/base/error.hpp"

namespace hemiray {
namespace {

static_assert(std::endian::native == std::endian::little, "glTF is little-endian");

constexpr std::uint32_t kMagic = 0x46546C67U, kJson = 0x4E4F534AU, kBinary = 0x004E4942U;
constexpr int kFloat = 5126, kArrayBuffer = 34962;
constexpr double kMeanShown = 0.4;

void append_word(std::string& out, std::uint32_t word) {
  out.append(reinterpret_cast<const char*>(&word), sizeof word);
}

void append_chunk(std::string& out, std::uint32_t kind, std::string data, char padding) {
  data.resize((data.size() + 3) / 4 * 4, padding);
  append_word(out, static_cast<std::uint32_t>(data.size()));
  append_word(out, kind);
  out += data;
}

// Corners, three a triangle that is shown.
struct Corners {
  std::vector<std::array<float, 3>> positions, normals, radiosity, colors;
};

bool is_lit(const PatchMesh& mesh, const std::vector<std::array<double, 3>>& irradiance, std::uint32_t side) {
  const auto &h = irradiance[side], &other = irradiance[side ^ 1U];
  const shared::float4 &e = mesh.emission[side], &tau = mesh.transmittance[side];
  return h[0] + h[1] + h[2] > 0.0 || e.x + e.y + e.z > 0.0F ||
         (tau.x + tau.y + tau.z > 0.0F && other[0] + other[1] + other[2] > 0.0);
}

Vec3 emission_of(const PatchMesh& mesh, std::uint32_t side) {
  const shared::Material& m = mesh.flat.materials[mesh.flat.triangles[side / 2].w];
  return side % 2 == 0 ? Vec3(m.emission.x, m.emission.y, m.emission.z) * std::numbers::pi_v<float> : Vec3(0.0F);
}

Corners corners_of(const PatchMesh& mesh, const std::vector<std::array<double, 3>>& irradiance,
                   const DisplayOptions& options) {
  const std::vector<std::array<float, 3>> light = corner_irradiance(mesh, irradiance, options);
  Corners corners;
  for (std::uint32_t side = 0; side < mesh.side_count(); side++) {
    if (!is_lit(mesh, irradiance, side)) continue;
    const shared::uint4& t = mesh.flat.triangles[side / 2];
    const std::array<std::uint32_t, 3> vertices = {t.x, t.y, t.z};
    const shared::float4& n = mesh.normals[side / 2];
    const float sign = side % 2 == 0 ? 1.0F : -1.0F;
    const shared::float4 &rho = mesh.reflectance[side], &tau = mesh.transmittance[side];
    const Vec3 e = emission_of(mesh, side);
    for (std::size_t i = 0; i < 3; i++) {
      const std::size_t corner = side % 2 == 0 ? i : 2 - i;
      const float* p = &mesh.flat.positions[std::size_t{3} * vertices[corner]];
      corners.positions.push_back({p[0], p[1], p[2]});
      corners.normals.push_back({sign * n.x, sign * n.y, sign * n.z});
      const auto &h = light[std::size_t{3} * side + corner], &other = light[std::size_t{3} * (side ^ 1U) + corner];
      corners.radiosity.push_back({e.x + rho.x * h[0] + tau.x * other[0], e.y + rho.y * h[1] + tau.y * other[1],
                                   e.z + rho.z * h[2] + tau.z * other[2]});
    }
  }
  return corners;
}

// Such that what is lit, but does not emit, is neither dark nor burnt out on average.
double automatic_exposure(const PatchMesh& mesh, const std::vector<std::array<double, 3>>& irradiance) {
  double sum = 0.0, area = 0.0;
  for (std::uint32_t side = 0; side < mesh.side_count(); side++) {
    const Vec3 e = emission_of(mesh, side);
    const auto& h = irradiance[side];
    if (e != Vec3(0.0F) || !(h[0] + h[1] + h[2] > 0.0)) continue;
    const shared::float4& rho = mesh.reflectance[side];
    const auto a = static_cast<double>(mesh.normals[side / 2].w);
    sum += a *
           (static_cast<double>(rho.x) * h[0] + static_cast<double>(rho.y) * h[1] + static_cast<double>(rho.z) * h[2]) /
           3.0;
    area += a;
  }
  return sum > 0.0 ? kMeanShown * area / sum : 1.0;
}

}  // namespace

std::string solution_as_glb(const PatchMesh& mesh, const std::vector<std::array<double, 3>>& irradiance,
                            const DisplayOptions& options, double exposure, GlbFacts& facts) {
  facts.exposure = exposure > 0.0 ? exposure : automatic_exposure(mesh, irradiance);
  Corners corners = corners_of(mesh, irradiance, options);
  if (corners.positions.empty()) {
    throw InputError("radiosity", "no light comes to any patch: there is nothing to write");
  }
  std::array<float, 3> lo, hi;
  lo.fill(std::numeric_limits<float>::infinity());
  hi.fill(-std::numeric_limits<float>::infinity());
  for (std::size_t i = 0; i < corners.positions.size(); i++) {
    std::array<float, 3> color{};
    for (std::size_t c = 0; c < 3; c++) {
      lo[c] = std::min(lo[c], corners.positions[i][c]);
      hi[c] = std::max(hi[c], corners.positions[i][c]);
      color[c] = std::clamp(static_cast<float>(facts.exposure) * corners.radiosity[i][c], 0.0F, 1.0F);
    }
    corners.colors.push_back(color);
  }
  std::string binary;
  nlohmann::ordered_json gltf;
  gltf["asset"] = {{"version", "2.0"}, {"generator", "hemiray"}};
  gltf["extensionsUsed"] = {"KHR_materials_unlit"};
  gltf["scene"] = 0;
  gltf["scenes"] = nlohmann::json::array({{{"nodes", {0}}}});
  gltf["nodes"] = nlohmann::json::array({{{"mesh", 0}, {"name", "radiosity"}}});
  gltf["materials"] = nlohmann::json::array(
      {{{"name", "radiosity"},
        {"pbrMetallicRoughness", {{"baseColorFactor", {1.0, 1.0, 1.0, 1.0}}, {"metallicFactor", 0.0}}},
        {"extensions", {{"KHR_materials_unlit", nlohmann::json::object()}}}}});
  nlohmann::ordered_json attributes;
  const auto add = [&](const char* name, const std::vector<std::array<float, 3>>& values) {
    attributes[name] = gltf["accessors"].size();
    nlohmann::ordered_json accessor = {{"bufferView", gltf["bufferViews"].size()},
                                       {"componentType", kFloat},
                                       {"count", values.size()},
                                       {"type", "VEC3"}};
    if (std::strcmp(name, "POSITION") == 0) {
      accessor["min"] = lo;
      accessor["max"] = hi;
    }
    const std::size_t bytes = values.size() * sizeof values[0];
    gltf["bufferViews"].push_back(
        {{"buffer", 0}, {"byteOffset", binary.size()}, {"byteLength", bytes}, {"target", kArrayBuffer}});
    gltf["accessors"].push_back(accessor);
    binary.append(reinterpret_cast<const char*>(values.data()), bytes);
  };
  add("POSITION", corners.positions);
  add("NORMAL", corners.normals);
  add("COLOR_0", corners.colors);
  add("_RADIOSITY", corners.radiosity);
  gltf["meshes"] =
      nlohmann::json::array({{{"name", "radiosity"},
                              {"primitives", nlohmann::json::array({{{"attributes", attributes}, {"material", 0}}})}}});
  gltf["meshes"][0]["extras"] = {{"exposure", facts.exposure}, {"unit", "W/m^2"}};
  gltf["buffers"] = nlohmann::json::array({{{"byteLength", binary.size()}}});

  std::string body;
  append_chunk(body, kJson, gltf.dump(), ' ');
  append_chunk(body, kBinary, binary, '\0');
  std::string file;
  append_word(file, kMagic);
  append_word(file, 2);
  append_word(file, static_cast<std::uint32_t>(body.size()) + 12);
  return file + body;
}

}  // namespace hemiray
