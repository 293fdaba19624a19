// Which hemiray this is; the values are generated at build time (cmake/Commit.cmake).
#pragma once

namespace hemiray {

extern const char* const kVersion;  ///< "major.minor.patch"
extern const char* const kCommit;  ///< first 12 hexadecimal digits of the commit built, or "unknown" outside a checkout

}  // namespace hemiray
