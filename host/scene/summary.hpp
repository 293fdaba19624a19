// What is in a scene, counted, for `hemiray check` and reports.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "host/scene/scene.hpp"

namespace hemiray {

struct ImplicitSummary {
  std::string name;
  std::uint32_t degree = 0;          ///< in x, y and z together
  std::uint32_t written_degree = 0;  ///< larger where the text repeats factors
  std::uint64_t instructions = 0;    ///< of its tape
  DVec3 bounds_min{0.0};             ///< of what its clip leaves of it [m]
  DVec3 bounds_max{0.0};
};

struct SceneSummary {
  std::string source;
  std::string title;
  std::uint64_t objects = 0;  ///< placed meshes
  std::uint64_t meshes = 0;
  std::uint64_t triangles = 0;         ///< as if every object had its own
  std::uint64_t vertices = 0;          ///< likewise
  std::uint64_t instances = 0;         ///< objects that share their mesh's triangles on the device
  std::uint64_t unique_triangles = 0;  ///< on the device: those of shared meshes once
  std::uint64_t spheres = 0;
  std::uint64_t disks = 0;
  std::uint64_t cylinders = 0;
  std::uint64_t cones = 0;
  std::uint64_t quadrics = 0;
  std::vector<ImplicitSummary> implicits;
  std::uint64_t planes = 0;
  std::uint64_t point_lights = 0;
  std::uint64_t directional_lights = 0;
  std::uint64_t spot_lights = 0;
  std::uint64_t area_lights = 0;
  std::uint64_t emissive_objects = 0;  ///< objects and spheres whose material emits
  std::uint64_t materials = 0;
  std::uint64_t textures = 0;
  std::uint64_t texture_bytes = 0;
  std::uint64_t dropped_triangles = 0;
  std::uint64_t device_bytes = 0;  ///< peak of a render at the scene's own size; filled by who can predict it
  int width = 0;                   ///< default image size [pixels]
  int height = 0;
  std::vector<double> bounds_min;  ///< [x, y, z] in m; empty where nothing is bounded
  std::vector<double> bounds_max;
  std::vector<std::string> notes;
};

/// Counts a valid scene.
SceneSummary summarize(const Scene& scene);

/// Some lines for people, each ended by a newline.
std::string summary_text(const SceneSummary& summary);

/// One JSON object, indented, ended by a newline; the keys are the members' names.
std::string summary_json(const SceneSummary& summary);

}  // namespace hemiray
