// Memory on the host that a CPU device works in directly, on huge pages, and what becomes of it when it is free.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace hemiray {

struct FreeHostMemory {
  void operator()(void* memory) const noexcept;
};

/// So many bytes, aligned to a huge page; empty by default.
struct HostMemory {
  std::unique_ptr<void, FreeHostMemory> memory;
  std::size_t bytes = 0;     ///< asked for
  std::size_t capacity = 0;  ///< there: a multiple of a huge page
};

/// Arrays of at least this size [bytes] are worth huge pages: tracing through a tree of a million triangles is 10 to
/// 25 % faster when the processor needs fewer page translations.
inline constexpr std::size_t kHugeMemoryBytes = std::size_t{4} << 20U;

/// `bytes` rounded up to huge pages; contents undefined. The system may still give small pages. Empty if there is not
/// enough memory.
HostMemory allocate_huge(std::size_t bytes);

/// Freed memory that waits to be used again: a new page costs the system as long to clear as a kernel needs to fill it.
class IdleHostMemory {
 public:
  /// The smallest piece that holds `bytes` and not much more, or a new one; of the others at most `most_idle` bytes
  /// wait on, the latest. Contents undefined; empty if there is not enough memory.
  HostMemory take(std::size_t bytes, std::uint64_t most_idle);
  void keep(HostMemory piece) noexcept;
  [[nodiscard]] std::uint64_t bytes() const { return bytes_; }

 private:
  void trim(std::uint64_t most_idle) noexcept;

  std::vector<HostMemory> pieces_;  ///< the latest last
  std::uint64_t bytes_ = 0;
};

}  // namespace hemiray
