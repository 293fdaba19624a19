// Plots of a benchmark's results, by bench/plot.py.
#pragma once

#include <filesystem>

namespace hemiray::app {

/// Throws InputError naming the package where python3 with matplotlib is missing (or what the environment's
/// HEMIRAY_PYTHON names).
void check_plotting();

/// Draws what is in the JSON file as PNG and SVG files into the folder. Throws DeviceError if the script fails (what it
/// says goes to stderr).
void plot_results(const std::filesystem::path& json, const std::filesystem::path& folder);

}  // namespace hemiray::app
