#include "host/gpu/host_memory.hpp"

#include <sys/mman.h>

#include <cstdlib>

namespace hemiray {

void FreeHostMemory::operator()(void* memory) const noexcept { std::free(memory); }

HostMemory allocate_huge(std::size_t bytes) {
  constexpr std::size_t kHugePage = std::size_t{2} << 20U;
  const std::size_t rounded = (bytes + kHugePage - 1) / kHugePage * kHugePage;
  HostMemory memory(std::aligned_alloc(kHugePage, rounded));
#ifdef MADV_HUGEPAGE
  if (memory) madvise(memory.get(), rounded, MADV_HUGEPAGE);  // a hint: a refusal costs speed only
#endif
  return memory;
}

}  // namespace hemiray
