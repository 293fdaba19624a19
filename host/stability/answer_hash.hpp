// A number that tells one set of answers from another: equal bits give equal numbers on every machine.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <type_traits>

namespace hemiray::stability {

/// FNV-1a over 32-bit words, 64 bits. Not made against malice.
class AnswerHash {
 public:
  template <typename T>
  void add(std::span<const T> answers) {
    static_assert(std::is_trivially_copyable_v<T> && sizeof(T) % sizeof(std::uint32_t) == 0);
    add_words(answers.data(), answers.size_bytes());
  }
  /// 16 hexadecimal digits.
  [[nodiscard]] std::string text() const;

 private:
  void add_words(const void* data, std::size_t bytes);
  std::uint64_t value_ = 0xcbf29ce484222325U;
};

}  // namespace hemiray::stability
