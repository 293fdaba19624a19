// Kernel sources: embedded in the program, overridden file by file from HEMIRAY_KERNEL_DIR, flattened by us.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace hemiray {

struct EmbeddedFile {
  const char* path;  ///< relative to kernels/
  const unsigned char* bytes;
  std::size_t size;
};

extern const EmbeddedFile kEmbeddedKernels[];
extern const std::size_t kEmbeddedKernelCount;

/// The text of one kernel source ("bvh/morton.cl"): from HEMIRAY_KERNEL_DIR if that folder has it, else embedded.
/// Throws InputError if there is no such file.
std::string kernel_source(const std::string& path);

/// The files one after the other with every #include "..." expanded once (.def files each time) and #line directives,
/// so that compile errors name the file at fault. This text is what is compiled, dumped and hashed: drivers never see
/// an include path.
std::string flatten_kernels(const std::vector<std::string>& paths);

/// A compiler's log about a flattened text, with "file:line" in place of "<kernel>:line": NVIDIA's counts the lines of
/// the text it was given and does not look at #line.
std::string name_sources(const std::string& log, const std::string& flattened);

}  // namespace hemiray
