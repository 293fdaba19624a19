#include "host/bvh/tree_chunks.hpp"

#include <algorithm>
#include <bit>
#include <utility>

#include <fmt/format.h>

#include "host/base/error.hpp"
#include "host/base/numbers.hpp"

namespace hemiray {
namespace {

constexpr std::uint64_t kMostChunks = 8;  // HR_BEHIND_FIRST_8 of kernels/lib/tree_chunks.h

void copy(Context& context, Kernel& copy_words, const Buffer<float>& from, std::uint64_t begin, std::uint64_t count,
          const Buffer<float>& to, std::uint64_t first) {
  // By a kernel: simulators take what a copy command wrote for uninitialised.
  launch(context, copy_words, context.profile().chunks,
         arguments(arg("from", from), arg("begin", begin), arg("count", count), arg("first", first), arg("to", to)));
}

}  // namespace

std::uint64_t largest_tree_buffer(const Context& context) {
  const std::uint64_t device = context.device().max_allocation_bytes;
  const std::uint64_t chosen = std::uint64_t{context.profile().tree_chunk_kib} << 10U;
  return chosen == 0 ? device : std::min(device, chosen);
}

ChunkLayout chunk_layout(const std::string& array, std::uint64_t elements, ChunkElement element,
                         std::uint64_t largest_bytes) {
  const std::uint64_t room = largest_bytes / (sizeof(float) * element.words);
  if (elements <= room) return {};
  ChunkLayout layout;
  const std::uint64_t chunk = room > element.repeats ? std::bit_floor(room - element.repeats) : 0;
  const std::uint64_t count = chunk > 0 ? (elements + chunk - 1) / chunk : kMostChunks + 1;
  if (count > kMostChunks) {
    throw DeviceError(fmt::format(
        "device memory: {} needs {}, too much for {} buffers of at most {}; take a smaller scene or a device that "
        "allows larger buffers, or raise tree_chunk_kib of the device profile where that is set",
        array, format_bytes(elements * element.words * sizeof(float)), kMostChunks, format_bytes(largest_bytes)));
  }
  layout.count = static_cast<unsigned>(count);
  layout.shift = static_cast<unsigned>(std::countr_zero(chunk));
  return layout;
}

TreeChunks::TreeChunks(Buffer<float> whole) : words_(whole.size()) { chunks_.push_back(std::move(whole)); }

TreeChunks::TreeChunks(Context& context, const std::string& array, std::uint64_t elements, ChunkElement element)
    : element_(element),
      layout_(chunk_layout(array, elements, element, largest_tree_buffer(context))),
      words_(elements * element.words) {
  if (layout_.count == 1) {
    chunks_.emplace_back(context, array, words_);
    return;
  }
  for (std::uint64_t first = 0; first < words_; first += chunk_words()) {
    const std::uint64_t most = chunk_words() + element_.repeats * element_.words;
    chunks_.emplace_back(context, array, std::min(most, words_ - first));
  }
}

std::uint64_t TreeChunks::bytes() const {
  std::uint64_t sum = 0;
  for (const Buffer<float>& chunk : chunks_) sum += chunk.bytes();
  return sum;
}

Arguments TreeChunks::arguments() const {
  Arguments all;
  for (std::size_t i = 0; i < chunks_.size(); i++) {
    const std::string& array = chunks_[i].name();
    all.push_back(arg((i == 0 ? array : fmt::format("{}_{}", array, i)).c_str(), chunks_[i]));
  }
  return all;
}

std::vector<float> TreeChunks::read(std::uint64_t first, std::uint64_t count) const {
  if (chunks_.size() == 1) return chunks_.front().read(first, count);
  std::vector<float> all;
  all.reserve(count);
  while (count > 0) {
    const std::uint64_t begin = first % chunk_words(), part = std::min(count, chunk_words() - begin);
    const std::vector<float> words = chunks_.at(first / chunk_words()).read(begin, part);
    all.insert(all.end(), words.begin(), words.end());
    first += part;
    count -= part;
  }
  return all;
}

void TreeChunks::copy_from(Context& context, Kernel& copy_words, const TreeChunks& from, std::uint64_t count,
                           std::uint64_t first) {
  // In runs that lie in one chunk here and in one there.
  const auto left_in_chunk = [](const TreeChunks& array, std::uint64_t at) {
    return array.chunks_.size() == 1 ? array.words_ - at : array.chunk_words() - at % array.chunk_words();
  };
  const auto place = [](const TreeChunks& array, std::uint64_t at) -> std::pair<const Buffer<float>&, std::uint64_t> {
    if (array.chunks_.size() == 1) return {array.chunks_.front(), at};
    return {array.chunks_.at(at / array.chunk_words()), at % array.chunk_words()};
  };
  const std::uint64_t words = count * element_.words, offset = first * element_.words;
  for (std::uint64_t at = 0; at < words;) {
    const std::uint64_t run = std::min({words - at, left_in_chunk(from, at), left_in_chunk(*this, offset + at)});
    const auto [source, begin] = place(from, at);
    const auto [target, to] = place(*this, offset + at);
    copy(context, copy_words, source, begin, run, target, to);
    at += run;
  }
}

void TreeChunks::repeat_first(Context& context, Kernel& copy_words) {
  if (!has_repeats()) return;
  for (std::size_t i = 1; i < chunks_.size(); i++) {
    const std::uint64_t room = chunks_[i - 1].size() - chunk_words();
    copy(context, copy_words, chunks_[i], 0, room, chunks_[i - 1], chunk_words());
  }
}

}  // namespace hemiray
