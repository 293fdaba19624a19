// Files that belong to the program: scenes, bars, scripts.
#pragma once

#include <filesystem>
#include <string>

namespace hemiray::app {

/// The file of that name (such as "scenes/cornell_box.json"): beside the installed program (PREFIX/share/hemiray), else
/// in the source tree it was built from. Throws InputError with the places looked at where there is none.
std::filesystem::path data_file(const std::string& name);

}  // namespace hemiray::app
