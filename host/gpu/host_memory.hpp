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

/// A piece of memory, aligned to a huge page; empty by default.
struct HostMemory {
  std::unique_ptr<void, FreeHostMemory> memory;
  std::size_t capacity = 0;  ///< a multiple of a huge page; at least what was asked for
};

/// Arrays of at least this size [bytes] are worth huge pages: tracing through a tree of a million triangles is 10 to
/// 25 % faster when the processor needs fewer page translations.
inline constexpr std::size_t kHugeMemoryBytes = std::size_t{4} << 20U;

/// `bytes` rounded up to huge pages; contents undefined. The system may still give small pages. Empty if there is not
/// enough memory.
HostMemory allocate_huge(std::size_t bytes);

/// Freed memory that waits to be used again: a new page costs the system as long to clear as a kernel needs to fill it.
/// What waits and what is in use, as much as they hold, are together never more than was in use at the peak.
class IdleHostMemory {
 public:
  /// The smallest piece that holds `bytes` and not much more, or a new one, for which the oldest of the others make
  /// room. Contents undefined; empty if there is not enough memory.
  HostMemory take(std::size_t bytes);
  /// Of a piece that take() gave.
  void keep(HostMemory piece) noexcept;
  /// What the pieces that wait hold [bytes].
  [[nodiscard]] std::uint64_t bytes() const { return bytes_; }

 private:
  HostMemory make(std::size_t bytes);
  void trim(std::uint64_t most_idle) noexcept;

  std::vector<HostMemory> pieces_;  ///< the latest last
  std::uint64_t bytes_ = 0, in_use_ = 0, most_in_use_ = 0;
};

}  // namespace hemiray
