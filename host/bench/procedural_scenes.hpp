// Scenes for benchmarks, made by rule to any number of triangles; the same bytes on every call.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "host/bench/view.hpp"
#include "host/scene/flat_scene.hpp"
#include "host/scene/scene.hpp"

namespace hemiray::bench {

/// A scene to measure: triangles alone, and the view they are measured from.
struct BenchScene {
  std::string name;
  FlatScene flat;
  View view;
  std::optional<FlatScene> instanced =
      std::nullopt;  ///< the same with a mesh shared by instances, primitives numbered alike
};

inline constexpr std::uint32_t kLeastTriangles = 10'000;
inline constexpr std::uint32_t kMostTriangles = 20'000'000;

/// interior, terrain, hair, instances.
std::span<const std::string_view> procedural_scene_names();

/// The scene of that name with `triangles` triangles give or take 1 %.
/// - interior: the room of the bars (bench/bars.json), 20 x 6 x 20 m: walls of two triangles, 30 tables, 40 columns of
///   tall thin triangles, a fine wavy floor (a quarter of the triangles), 14 bumpy spheres (40 %), the rest in clusters
///   of small boxes of very uneven size. Seen from a corner.
/// - terrain: hills of several octaves, 100 x 100 m, triangles of about equal size.
/// - hair: ribbons of 16 triangles, 25 cm long and half a millimetre wide, on a ball of 20 cm.
/// - instances: instanced_scene(), as copies and as instances.
/// Throws InputError for another name, or a count outside kLeastTriangles to kMostTriangles.
BenchScene procedural_scene(std::string_view name, std::uint32_t triangles);

/// Objects that share one mesh of 192 triangles (a bumpy ball), turned, scaled and scattered: as many as give
/// `triangles` within 1 %.
Scene instanced_scene(std::uint32_t triangles);

}  // namespace hemiray::bench
