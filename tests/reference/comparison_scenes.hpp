// The scenes on which a renderer is compared with the reference tracer.
#pragma once

#include <string>
#include <vector>

#include "tests/reference/scene_builder.hpp"
#include "tests/reference/whitted_reference.hpp"

namespace hemiray::reference {

struct ComparisonScene {
  std::string name;
  Scene scene;
  ReferenceOptions options;
};

/// About a dozen small scenes that together use every feature of the Whitted tracer.
std::vector<ComparisonScene> comparison_scenes();

}  // namespace hemiray::reference
