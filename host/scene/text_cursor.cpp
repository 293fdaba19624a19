// Line, column and strict number reading for the text formats.
#include "host/scene/text_cursor.hpp"

#include <charconv>
#include <cmath>
#include <limits>
#include <system_error>
#include <utility>

#include "host/base/error.hpp"
#include "host/base/spelling.hpp"

namespace hemiray {

namespace {

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\v' || c == '\f'; }

// from_chars reports both overflow and underflow as out of range; a number too small to represent is an honest zero.
bool underflows(std::string_view token) {
  const std::size_t exponent = token.find_first_of("eE");
  return exponent != std::string_view::npos && exponent + 1 < token.size() && token[exponent + 1] == '-';
}

}  // namespace

TextCursor::TextCursor(std::string_view text, std::string file, Syntax syntax)
    : text_(text), file_(std::move(file)), syntax_(syntax) {
  if (text_.substr(0, 3) == "\xEF\xBB\xBF") pos_ = line_start_ = token_begin_ = token_line_start_ = 3;
}

std::size_t TextCursor::line_break_length(std::size_t offset) const {
  if (offset >= text_.size()) return 0;
  if (text_[offset] == '\n') return 1;
  if (text_[offset] == '\r') return offset + 1 < text_.size() && text_[offset + 1] == '\n' ? 2 : 1;
  return 0;
}

void TextCursor::skip_blanks() {
  while (pos_ < text_.size()) {
    const char c = text_[pos_];
    if (is_blank(c)) {
      ++pos_;
      continue;
    }
    if (syntax_ == Syntax::plain) return;
    if (c == '\\' && line_break_length(pos_ + 1) > 0) {
      pos_ += 1 + line_break_length(pos_ + 1);
      ++line_;
      line_start_ = pos_;
      continue;
    }
    if (c == '#') {
      while (pos_ < text_.size() && line_break_length(pos_) == 0) ++pos_;
    }
    return;
  }
}

void TextCursor::scan_token() {
  while (pos_ < text_.size() && !is_blank(text_[pos_]) && line_break_length(pos_) == 0) {
    if (syntax_ == Syntax::obj && text_[pos_] == '\\' && line_break_length(pos_ + 1) > 0) return;
    ++pos_;
  }
}

bool TextCursor::next_line() {
  if (started_) {
    for (skip_blanks(); pos_ < text_.size() && line_break_length(pos_) == 0; skip_blanks()) scan_token();
  }
  started_ = true;
  for (;;) {
    if (!at_line_end()) return true;
    const std::size_t length = line_break_length(pos_);
    if (length == 0) {
      token_begin_ = pos_;
      token_line_ = line_;
      token_line_start_ = line_start_;
      return false;
    }
    pos_ += length;
    ++line_;
    line_start_ = pos_;
  }
}

std::string_view TextCursor::token() {
  skip_blanks();
  token_begin_ = pos_;
  token_line_ = line_;
  token_line_start_ = line_start_;
  scan_token();
  return text_.substr(token_begin_, pos_ - token_begin_);
}

std::string_view TextCursor::rest() {
  token();  // sets the place
  pos_ = token_begin_;
  std::size_t end = pos_;
  while (pos_ < text_.size() && line_break_length(pos_) == 0) {
    const bool after_blank = pos_ > token_begin_ && is_blank(text_[pos_ - 1]);
    if (syntax_ == Syntax::obj && text_[pos_] == '#' && after_blank) break;
    if (syntax_ == Syntax::obj && text_[pos_] == '\\' && line_break_length(pos_ + 1) > 0) break;
    if (!is_blank(text_[pos_])) end = pos_ + 1;
    ++pos_;
  }
  return text_.substr(token_begin_, end - token_begin_);
}

bool TextCursor::at_line_end() {
  skip_blanks();
  return pos_ >= text_.size() || line_break_length(pos_) > 0;
}

std::size_t TextCursor::offset_after_line() const {
  std::size_t end = pos_;
  while (end < text_.size() && line_break_length(end) == 0) ++end;
  return end + line_break_length(end);
}

double TextCursor::parse_number(std::string_view token, std::string_view what) const {
  if (token.empty()) fail_at(token, std::string(what) + ": a number is missing");
  std::string_view digits = token;
  if (digits[0] == '+' && digits.size() > 1 && digits[1] != '-' && digits[1] != '+') digits.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  const bool whole = end == digits.data() + digits.size();
  if (error == std::errc::invalid_argument || !whole) {
    fail_at(token, std::string(what) + ": '" + printable(token) + "' is not a number");
  }
  if (error == std::errc::result_out_of_range) {
    if (underflows(digits)) return 0.0;
    fail_at(token, std::string(what) + ": '" + printable(token) + "' is out of range");
  }
  if (!std::isfinite(value)) fail_at(token, std::string(what) + ": '" + printable(token) + "' is not finite");
  return value;
}

double TextCursor::number(std::string_view what) { return parse_number(token(), what); }

float TextCursor::number_f(std::string_view what) {
  const std::string_view digits = token();
  const double value = parse_number(digits, what);
  if (std::abs(value) > static_cast<double>(std::numeric_limits<float>::max())) {
    fail(std::string(what) + ": '" + printable(digits) + "' is out of range");
  }
  return static_cast<float>(value);
}

std::int64_t TextCursor::integer(std::string_view what, std::int64_t low, std::int64_t high) {
  const std::string_view digits = token();
  if (digits.empty()) fail(std::string(what) + ": a number is missing");
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error == std::errc::invalid_argument || end != digits.data() + digits.size()) {
    fail(std::string(what) + ": '" + printable(digits) + "' is not an integer");
  }
  if (error != std::errc{} || value < low || value > high) {
    fail(std::string(what) + ": '" + printable(digits) + "' is not between " + std::to_string(low) + " and " +
         std::to_string(high));
  }
  return value;
}

void TextCursor::expect_line_end() {
  if (at_line_end()) return;
  const std::string_view extra = token();
  fail("unexpected '" + printable(extra) + "' at the end of the line; remove it");
}

std::string TextCursor::place_at(std::size_t offset) const {
  return file_ + ":" + std::to_string(token_line_) + ":" + std::to_string(offset - token_line_start_ + 1);
}

void TextCursor::fail(std::string_view message) const { throw InputError(place(), message); }

void TextCursor::fail_at(std::string_view part, std::string_view message) const {
  throw InputError(place_at(static_cast<std::size_t>(part.data() - text_.data())), message);
}

}  // namespace hemiray
