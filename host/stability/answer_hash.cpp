#include "host/stability/answer_hash.hpp"

#include <fmt/format.h>

#include <cstring>

namespace hemiray::stability {

void AnswerHash::add_words(const void* data, std::size_t bytes) {
  constexpr std::uint64_t kPrime = 0x100000001b3U;
  constexpr std::uint32_t kMinusZero = 0x80000000U;  // the sign of a zero is no answer
  const auto* at = static_cast<const unsigned char*>(data);
  for (std::size_t i = 0; i < bytes; i += sizeof(std::uint32_t)) {
    std::uint32_t word = 0;
    std::memcpy(&word, at + i, sizeof word);
    value_ = (value_ ^ (word == kMinusZero ? 0U : word)) * kPrime;
  }
}

std::string AnswerHash::text() const { return fmt::format("{:016x}", value_); }

}  // namespace hemiray::stability
