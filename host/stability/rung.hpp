// A rung of the ladder: one scene, and what is asked of it. A case is a row of rungs, each harder than the one before.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "host/gpu/context.hpp"
#include "host/scene/flat_scene.hpp"
#include "host/stability/aim.hpp"
#include "host/stability/answer_hash.hpp"
#include "host/stability/rates.hpp"

namespace hemiray::stability {

/// hits: closest hits of the rays, judged by the oracle. leaving: the rays' hits send rays on, as the renderer does.
/// picture: a small scene is rendered and its pixels are judged.
enum class RungKind { hits, leaving, picture };

/// What a ray that has left a surface must do.
enum class After {
  convex,  ///< the scene is one convex solid: outside it meets nothing, inside the far side
  layer,   ///< the first half of the primitives is a sheet, the second the same one behind it: it goes on to that one
};

/// How a rung's pictures are to be rendered.
struct PictureRun {
  Context& context;
  std::uint32_t pixels;  ///< about so many
  bool double_precision;
  bool strict;
  AnswerHash& answers;  ///< gets what is rendered
};

struct Rung {
  std::string name;
  RungKind kind = RungKind::hits;
  FlatScene flat;
  RayMaker rays;
  After after = After::convex;
  /// Renders and judges the pixels.
  std::function<Tally(const PictureRun& run)> picture;
};

struct Case {
  std::string name;
  std::string what;                          ///< one sentence: the scene, the rays, what a rung's name measures
  std::vector<std::function<Rung()>> rungs;  ///< made one at a time: some are large
};

/// All, in the order of the report.
std::vector<Case> all_cases();

// Its parts, one file each.
std::vector<Case> place_cases();  ///< scale, translation, sizes
std::vector<Case> shape_cases();  ///< slivers, closed meshes, touching and coplanar surfaces, grazing rays
std::vector<Case> sphere_cases();
std::vector<Case> analytic_cases();  ///< disks, cylinders, cones, quadrics
std::vector<Case> implicit_cases();
std::vector<Case> degenerate_cases();  ///< vertices that are no good, and trees that cannot tell primitives apart
std::vector<Case> leaving_cases();     ///< secondary rays
std::vector<Case> instance_cases();    ///< those of instances
std::vector<Case> picture_cases();

}  // namespace hemiray::stability
