// The options of radiosity that `render --method radiosity` and `solve` share, and what is printed about a solution.
#pragma once

#include <CLI/CLI.hpp>

#include <cstdint>
#include <string>
#include <vector>

#include "host/radiosity/radiosity.hpp"
#include "host/scene/scene.hpp"

namespace hemiray::app {

struct RadiosityArguments {
  std::uint32_t patches = 4000, resolution = 0, points = 1, iterations = 10000, seed = 0, shots = 16,
                residual_samples = 4096, pair_rays = 1024, gather_rays = 0, refine = 0;
  double keep_every = 30.0, edge = 0.0, chord = 0.0, tolerance = 1e-4, seconds = 0.0, crease = 20.0, factor_mib = 0.0;
  std::string form_factors = "hybrid", solver = "auto", pick = "power", display = "smooth", cells = "turned",
              pair_search = "rays", precision = "single", save, resume;
  std::vector<CLI::Option*> given;  ///< all of them: to tell whether one was used
};

/// Those of mesh and form factors.
void add_mesh_options(CLI::App& command, RadiosityArguments& arguments);
/// These, and those of solution and display.
void add_radiosity_options(CLI::App& command, RadiosityArguments& arguments);

/// Those that only a picture has.
void add_picture_options(CLI::App& command, RadiosityArguments& arguments);

/// Throws InputError for values out of range, and for a file to save in that is there, cannot be written or is one of
/// `others`, which are read or written, too.
RadiosityOptions to_radiosity_options(const RadiosityArguments& arguments, const std::vector<std::string>& others = {});
/// What of a scene radiosity leaves out, and a method without it: a line each.
std::vector<std::string> left_out_by_radiosity(const Scene& scene);
std::vector<std::string> left_out_without_radiosity(const Scene& scene);
/// Says on stderr, after an interrupt, where what was computed is.
void tell_kept(const KeepOptions& keep, const RadiosityStatistics& statistics);
DisplayOptions to_display_options(const RadiosityArguments& arguments);

/// A few lines: mesh, form factors, solution, times.
std::string radiosity_table(const Radiosity& radiosity);
/// The same as a JSON object, with the convergence history and these notes.
std::string radiosity_json(const Radiosity& radiosity, const std::vector<std::string>& notes);

}  // namespace hemiray::app
