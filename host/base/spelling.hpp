// Names as they appear in messages: the nearest right spelling of a wrong one, and safe quoting of user text.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace hemiray {

/// The candidate with the smallest edit distance to `word` (insertions, deletions, substitutions and swaps of
/// neighbours count 1; upper and lower case are equal), or an empty view where none is near: more than 1 (words under 4
/// letters), 2 (under 8) or 3 edits away, or no letter in common.
std::string_view nearest_spelling(std::string_view word, std::span<const std::string_view> candidates);

/// The first character of `text` in UTF-8, whole; nothing of nothing.
std::string_view first_character(std::string_view text);

/// `text` made fit for a one-line message: control bytes escaped, cut after 60 bytes, between characters.
std::string printable(std::string_view text);

/// printable(text) in double quotes.
std::string in_quotes(std::string_view text);

/// `; did you mean "x"?` where a candidate is near, else `; known: a, b, c` (at most 12 names, then "..."), or nothing
/// where there are no candidates.
std::string spelling_hint(std::string_view word, std::span<const std::string_view> candidates);

}  // namespace hemiray
