// The nodes or the blocks of a tree on the device: one buffer, or several where the device allows none so large.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "host/bvh/accel_config.hpp"
#include "host/gpu/buffer.hpp"
#include "host/gpu/program.hpp"

namespace hemiray {

/// Of an array that is dealt out to chunks.
struct ChunkElement {
  std::size_t words = 1;      ///< 4 bytes each
  std::uint64_t repeats = 0;  ///< so many of a chunk's first ones stand behind the chunk before it, too
};

/// The largest buffer of nodes or of blocks [bytes]: the device's largest allocation, or what its profile says.
std::uint64_t largest_tree_buffer(const Context& context);

/// The fewest chunks of 2^shift elements, in buffers of at most `largest_bytes`; one chunk if all fits one. Throws
/// DeviceError, naming `array`, if more than 8 (kernels/lib/tree_chunks.h) were needed.
ChunkLayout chunk_layout(const std::string& array, std::uint64_t elements, ChunkElement element,
                         std::uint64_t largest_bytes);

/// Owns an array's chunks. Members throw DeviceError.
class TreeChunks {
 public:
  TreeChunks() = default;
  /// One buffer, whatever its size.
  explicit TreeChunks(Buffer<float> whole);
  /// `elements` of them, undefined, in the fewest chunks. `array`: the first one's name in kernels.
  TreeChunks(Context& context, const std::string& array, std::uint64_t elements, ChunkElement element);

  [[nodiscard]] const ChunkLayout& layout() const { return layout_; }
  [[nodiscard]] std::uint64_t bytes() const;
  /// array, array_1, array_2, ... for kernels compiled for this layout.
  [[nodiscard]] Arguments arguments() const;
  /// All elements' words in order, as if they lay in one buffer; or `count` words from `first` on.
  [[nodiscard]] std::vector<float> read() const { return read(0, words_); }
  [[nodiscard]] std::vector<float> read(std::uint64_t first, std::uint64_t count) const;

  /// Queues copies of `from`'s first `count` elements, of the same kind, to those from `first` on; `copy_words`:
  /// kernels/bvh/copy_words.cl.
  void copy_from(Context& context, Kernel& copy_words, const TreeChunks& from, std::uint64_t count,
                 std::uint64_t first);
  /// Queues copies of each chunk's first elements behind the chunk before it, to be called when they have changed.
  void repeat_first(Context& context, Kernel& copy_words);
  /// Whether there is anything for repeat_first() to do.
  [[nodiscard]] bool has_repeats() const { return layout_.count > 1 && element_.repeats > 0; }

 private:
  [[nodiscard]] std::uint64_t chunk_words() const { return element_.words << layout_.shift; }

  ChunkElement element_;
  ChunkLayout layout_;
  std::uint64_t words_ = 0;  ///< of all elements, repeated ones once
  std::vector<Buffer<float>> chunks_;
};

}  // namespace hemiray
