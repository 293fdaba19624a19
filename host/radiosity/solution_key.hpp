// What decides the bits of a solution.
#pragma once

#include <string>

#include "host/radiosity/radiosity.hpp"

namespace hemiray {

/// A JSON object of names and values: program, kernels, device, scene, and all options that change what is computed.
/// Where two are equal, the same bits come out.
std::string solution_key(const Context& context, const FlatScene& flat, const RadiosityOptions& options);

/// "--patches (500 there, 4000 now), scene": in what two keys differ; empty: in nothing. `old_key` comes from a file:
/// InputError if it is no key.
std::string difference_of_keys(const std::string& old_key, const std::string& new_key);

}  // namespace hemiray
