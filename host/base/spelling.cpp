// Edit distance (optimal string alignment) for messages.
#include "host/base/spelling.hpp"

#include <algorithm>
#include <cctype>
#include <vector>

namespace hemiray {
namespace {

constexpr std::size_t kMaxShownBytes = 60;
constexpr std::size_t kLongestName = 64;  // longer words get no suggestion: the table is quadratic

bool is_continuation(char c) { return (static_cast<unsigned char>(c) & 0xc0) == 0x80; }

char lower(char c) { return static_cast<char>(std::tolower(static_cast<unsigned char>(c))); }

std::size_t edit_distance(std::string_view a, std::string_view b) {
  const std::size_t width = b.size() + 1;
  std::vector<std::size_t> table((a.size() + 1) * width);
  for (std::size_t j = 0; j < width; ++j) table[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    table[i * width] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t substitution = lower(a[i - 1]) == lower(b[j - 1]) ? 0 : 1;
      std::size_t best = std::min({table[(i - 1) * width + j] + 1, table[i * width + j - 1] + 1,
                                   table[(i - 1) * width + j - 1] + substitution});
      const bool swapped = i > 1 && j > 1 && lower(a[i - 1]) == lower(b[j - 2]) && lower(a[i - 2]) == lower(b[j - 1]);
      if (swapped) best = std::min(best, table[(i - 2) * width + j - 2] + 1);
      table[i * width + j] = best;
    }
  }
  return table.back();
}

}  // namespace

std::string_view nearest_spelling(std::string_view word, std::span<const std::string_view> candidates) {
  if (word.empty() || word.size() > kLongestName) return {};
  std::string_view best;
  std::size_t best_distance = (word.size() < 4 ? 1 : word.size() < 8 ? 2 : 3) + 1;
  for (const std::string_view candidate : candidates) {
    if (candidate.size() > kLongestName) continue;
    const std::size_t distance = edit_distance(word, candidate);
    const bool nothing_shared = distance >= std::max(word.size(), candidate.size());
    if (distance < best_distance && !nothing_shared) {
      best = candidate;
      best_distance = distance;
    }
  }
  return best;
}

std::string_view first_character(std::string_view text) {
  std::size_t size = std::min<std::size_t>(text.size(), 1);
  while (size < std::min<std::size_t>(text.size(), 4) && is_continuation(text[size])) size++;
  return text.substr(0, size);
}

std::string printable(std::string_view text) {
  static constexpr char kHex[] = "0123456789abcdef";
  std::string shown;
  std::size_t end = std::min(text.size(), kMaxShownBytes);
  while (end > 0 && end < text.size() && is_continuation(text[end])) end--;
  for (const char c : text.substr(0, end)) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x20 || byte == 0x7f) {
      shown += {'\\', 'x', kHex[byte >> 4], kHex[byte & 15]};
    } else {
      shown += c;
    }
  }
  if (text.size() > kMaxShownBytes) shown += "...";
  return shown;
}

std::string in_quotes(std::string_view text) { return "\"" + printable(text) + "\""; }

std::string spelling_hint(std::string_view word, std::span<const std::string_view> candidates) {
  if (candidates.empty()) return {};
  const std::string_view nearest = nearest_spelling(word, candidates);
  if (!nearest.empty()) return "; did you mean " + in_quotes(nearest) + "?";
  constexpr std::size_t kListed = 12;
  std::string hint = "; known: ";
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    if (i > 0) hint += ", ";
    if (i == kListed && candidates.size() > kListed + 1) return hint + "...";
    hint += printable(candidates[i]);
  }
  return hint;
}

}  // namespace hemiray
