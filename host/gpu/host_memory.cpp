#include "host/gpu/host_memory.hpp"

#include <sys/mman.h>

#include <algorithm>
#include <cstdlib>
#include <utility>

namespace hemiray {
namespace {

constexpr std::size_t kHugePage = std::size_t{2} << 20U;

std::size_t in_huge_pages(std::size_t bytes) { return (bytes + kHugePage - 1) / kHugePage * kHugePage; }

}  // namespace

void FreeHostMemory::operator()(void* memory) const noexcept { std::free(memory); }

HostMemory allocate_huge(std::size_t bytes) {
  HostMemory piece;
  piece.capacity = in_huge_pages(bytes);
  piece.memory.reset(std::aligned_alloc(kHugePage, piece.capacity));
#ifdef MADV_HUGEPAGE
  if (piece.memory) madvise(piece.memory.get(), piece.capacity, MADV_HUGEPAGE);  // a hint: a refusal costs speed only
#endif
  return piece;
}

HostMemory IdleHostMemory::take(std::size_t bytes) {
  const std::size_t wanted = in_huge_pages(bytes), most = wanted + wanted / 2;
  std::size_t best = pieces_.size();
  for (std::size_t i = 0; i < pieces_.size(); i++) {
    if (pieces_[i].capacity < wanted || pieces_[i].capacity > most) continue;
    if (best == pieces_.size() || pieces_[i].capacity < pieces_[best].capacity) best = i;
  }
  if (best == pieces_.size()) return make(bytes);
  HostMemory piece = std::move(pieces_[best]);
  pieces_.erase(pieces_.begin() + static_cast<std::ptrdiff_t>(best));
  bytes_ -= piece.capacity;
  in_use_ += piece.capacity;
  return piece;
}

HostMemory IdleHostMemory::make(std::size_t bytes) {
  const std::uint64_t then = in_use_ + in_huge_pages(bytes);
  trim(std::max(most_in_use_, then) - then);
  HostMemory piece = allocate_huge(bytes);
  if (!piece.memory) return {};
  in_use_ = then;
  most_in_use_ = std::max(most_in_use_, in_use_);
  return piece;
}

void IdleHostMemory::keep(HostMemory piece) noexcept {
  const std::size_t size = piece.capacity;
  in_use_ -= size;
  try {
    pieces_.push_back(std::move(piece));
    bytes_ += size;
  } catch (...) {
    // No memory for the list: the piece is freed.
  }
}

void IdleHostMemory::trim(std::uint64_t most_idle) noexcept {
  std::size_t dropped = 0;
  while (bytes_ > most_idle) bytes_ -= pieces_[dropped++].capacity;
  pieces_.erase(pieces_.begin(), pieces_.begin() + static_cast<std::ptrdiff_t>(dropped));
}

}  // namespace hemiray
