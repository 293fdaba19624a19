// Counting a scene, and the two ways to print the count.
#include "host/scene/summary.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "host/base/numbers.hpp"
#include "host/base/spelling.hpp"
#include "host/scene/bounds.hpp"
#include "host/scene/emission.hpp"
#include "host/scene/instancing.hpp"
#include "host/scene/shape_geometry.hpp"

namespace hemiray {
namespace {

void count_lights(const Scene& scene, SceneSummary& summary) {
  for (const Light& light : scene.lights) {
    switch (light.kind) {
      case LightKind::point:
        ++summary.point_lights;
        break;
      case LightKind::directional:
        ++summary.directional_lights;
        break;
      case LightKind::spot:
        ++summary.spot_lights;
        break;
      case LightKind::area:
        ++summary.area_lights;
        break;
    }
  }
  summary.emissive_objects = count_emitters(scene);
}

void count_shapes(const Scene& scene, SceneSummary& summary) {
  for (const Shape& shape : scene.shapes) {
    switch (shape.kind) {
      case ShapeKind::disk:
        ++summary.disks;
        break;
      case ShapeKind::cylinder:
        ++summary.cylinders;
        break;
      case ShapeKind::cone:
        ++summary.cones;
        break;
      case ShapeKind::quadric:
        ++summary.quadrics;
        break;
      case ShapeKind::implicit: {
        const WorldBounds bounds = shape_bounds(shape);
        summary.implicits.push_back({shape.name, shape.expression.degree, shape.expression.written_degree,
                                     shape.expression.tape.size(), bounds.min, bounds.max});
        break;
      }
    }
  }
}

void count_instances(const Scene& scene, SceneSummary& summary) {
  const std::vector<bool> instanced = instanced_objects(scene, Instancing::automatic);
  std::vector<bool> counted(scene.meshes.size(), false);
  for (std::size_t i = 0; i < scene.objects.size(); i++) {
    const std::uint32_t mesh = scene.objects[i].mesh;
    if (instanced[i]) summary.instances++;
    if (!instanced[i] || !counted[mesh]) summary.unique_triangles += scene.meshes[mesh].triangles.size();
    if (instanced[i]) counted[mesh] = true;
  }
}

// "a, b, c" of those that are not zero, or "none".
std::string list_counts(const std::vector<std::pair<std::uint64_t, const char*>>& counts) {
  std::string result;
  for (const auto& [count, what] : counts) {
    if (count == 0) continue;
    result += (result.empty() ? "" : ", ") + format_count(count, what);
  }
  return result.empty() ? "none" : result;
}

}  // namespace

SceneSummary summarize(const Scene& scene) {
  SceneSummary summary;
  summary.source = scene.source.string();
  summary.title = scene.title;
  summary.objects = scene.objects.size();
  summary.meshes = scene.meshes.size();
  for (const Object& object : scene.objects) {
    summary.triangles += scene.meshes[object.mesh].triangles.size();
    summary.vertices += scene.meshes[object.mesh].positions.size();
  }
  count_instances(scene, summary);
  summary.spheres = scene.spheres.size();
  count_shapes(scene, summary);
  summary.planes = scene.planes.size();
  count_lights(scene, summary);
  summary.materials = scene.materials.size();
  summary.textures = scene.textures.size();
  for (const Texture& texture : scene.textures) summary.texture_bytes += texture.rgba.size();
  summary.dropped_triangles = scene.dropped_triangles;
  summary.width = scene.camera.width;
  summary.height = scene.camera.height;
  const WorldBounds bounds = world_bounds(scene);
  if (!bounds.empty()) {
    summary.bounds_min = {bounds.min.x, bounds.min.y, bounds.min.z};
    summary.bounds_max = {bounds.max.x, bounds.max.y, bounds.max.z};
  }
  summary.notes = scene.notes;
  return summary;
}

std::string summary_text(const SceneSummary& s) {
  std::string text = fmt::format("{}: valid", s.source.empty() ? "scene" : s.source);
  if (!s.title.empty()) text += fmt::format(" ({})", s.title);
  text += "\n";
  const auto row = [&](const char* name, const std::string& value) {
    text += fmt::format("  {:<10} {}\n", name, value);
  };
  row("image", fmt::format("{} x {} pixels", s.width, s.height));
  row("geometry", list_counts({{s.objects, "object"},
                               {s.spheres, "sphere"},
                               {s.disks, "disk"},
                               {s.cylinders, "cylinder"},
                               {s.cones, "cone"},
                               {s.quadrics, "quadric"},
                               {s.implicits.size(), "implicit surface"},
                               {s.planes, "plane"}}));
  for (const ImplicitSummary& i : s.implicits) {
    row("implicit",
        fmt::format("{}degree {}{}, {} instructions, within [{:.4g}, {:.4g}, {:.4g}] to [{:.4g}, {:.4g}, "
                    "{:.4g}] m",
                    i.name.empty() ? "" : printable(i.name) + ": ", i.degree,
                    i.degree < i.written_degree ? fmt::format(" ({} with repeated factors)", i.written_degree) : "",
                    i.instructions, i.bounds_min.x, i.bounds_min.y, i.bounds_min.z, i.bounds_max.x, i.bounds_max.y,
                    i.bounds_max.z));
  }
  row("triangles", fmt::format("{} over {} in {}", format_count(s.triangles), format_count(s.vertices) + " vertices",
                               s.meshes == 1 ? "1 mesh" : format_count(s.meshes) + " meshes"));
  if (s.instances > 0) {
    row("instances", fmt::format("{} that share their triangles: {} on the device", format_count(s.instances),
                                 format_count(s.unique_triangles)));
  }
  row("lights", list_counts({{s.point_lights, "point light"},
                             {s.directional_lights, "directional light"},
                             {s.spot_lights, "spot light"},
                             {s.area_lights, "area light"},
                             {s.emissive_objects, "emissive object"}}));
  row("materials", format_count(s.materials));
  if (s.textures > 0) row("textures", fmt::format("{} ({})", format_count(s.textures), format_bytes(s.texture_bytes)));
  if (!s.bounds_min.empty()) {
    row("bounds", fmt::format("[{:.4g}, {:.4g}, {:.4g}] to [{:.4g}, {:.4g}, {:.4g}] m", s.bounds_min[0],
                              s.bounds_min[1], s.bounds_min[2], s.bounds_max[0], s.bounds_max[1], s.bounds_max[2]));
  }
  row("memory", fmt::format("{} on the device at {} x {}", format_bytes(s.device_bytes), s.width, s.height));
  if (s.dropped_triangles > 0) {
    row("dropped", fmt::format("{} without area or not finite", format_count(s.dropped_triangles, "triangle")));
  }
  for (const std::string& note : s.notes) row("note", note);
  return text;
}

static nlohmann::ordered_json implicits_json(const SceneSummary& s) {
  auto all = nlohmann::ordered_json::array();
  for (const ImplicitSummary& i : s.implicits) {
    all.push_back({{"name", i.name},
                   {"degree", i.degree},
                   {"written_degree", i.written_degree},
                   {"instructions", i.instructions},
                   {"bounds_min", {i.bounds_min.x, i.bounds_min.y, i.bounds_min.z}},
                   {"bounds_max", {i.bounds_max.x, i.bounds_max.y, i.bounds_max.z}}});
  }
  return all;
}

std::string summary_json(const SceneSummary& s) {
  const nlohmann::ordered_json json = {{"source", s.source},
                                       {"title", s.title},
                                       {"width", s.width},
                                       {"height", s.height},
                                       {"objects", s.objects},
                                       {"meshes", s.meshes},
                                       {"triangles", s.triangles},
                                       {"vertices", s.vertices},
                                       {"instances", s.instances},
                                       {"unique_triangles", s.unique_triangles},
                                       {"spheres", s.spheres},
                                       {"disks", s.disks},
                                       {"cylinders", s.cylinders},
                                       {"cones", s.cones},
                                       {"quadrics", s.quadrics},
                                       {"implicits", implicits_json(s)},
                                       {"planes", s.planes},
                                       {"point_lights", s.point_lights},
                                       {"directional_lights", s.directional_lights},
                                       {"spot_lights", s.spot_lights},
                                       {"area_lights", s.area_lights},
                                       {"emissive_objects", s.emissive_objects},
                                       {"materials", s.materials},
                                       {"textures", s.textures},
                                       {"texture_bytes", s.texture_bytes},
                                       {"dropped_triangles", s.dropped_triangles},
                                       {"device_bytes", s.device_bytes},
                                       {"bounds_min", s.bounds_min},
                                       {"bounds_max", s.bounds_max},
                                       {"notes", s.notes}};
  // Names come from files: a byte that is no UTF-8 must not stop the report.
  return json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

}  // namespace hemiray
