#include <iterator>
#include <utility>

#include "host/stability/rung.hpp"

namespace hemiray::stability {

std::vector<Case> all_cases() {
  std::vector<Case> all;
  for (auto part : {place_cases, shape_cases, sphere_cases, analytic_cases, implicit_cases, degenerate_cases,
                    leaving_cases, instance_cases, picture_cases}) {
    std::vector<Case> cases = part();
    all.insert(all.end(), std::make_move_iterator(cases.begin()), std::make_move_iterator(cases.end()));
  }
  return all;
}

}  // namespace hemiray::stability
