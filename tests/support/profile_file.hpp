// A device profile of a test's own.
#pragma once

#include <string>

#include "tests/support/kernel_folder.hpp"

namespace hemiray::test {

/// A file with this text that HEMIRAY_PROFILE names while it lives.
/// A tree that packets can walk, on devices that have no vectors of their own, too.
inline const std::string kVectorLayout = R"("explicit_vectors": 1, "bvh_width": 8, "leaf_lanes": 8)";

class ProfileFile {
 public:
  explicit ProfileFile(const std::string& text) : variable_("HEMIRAY_PROFILE", folder_.write("profile.json", text)) {}

  /// A profile for every device, by the inside of its JSON object: `"bvh_width": 4`.
  static std::string for_all(const std::string& fields) { return R"({"profiles": [{)" + fields + "}]}"; }

 private:
  TempFolder folder_;
  ScopedVariable variable_;
};

}  // namespace hemiray::test
