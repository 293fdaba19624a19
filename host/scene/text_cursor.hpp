// Walks over a text file line by line and token by token, and knows the line and column of each token.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace hemiray {

/// Tokens are separated by blanks and tabs; lines end with LF, CR LF or CR. In the OBJ syntax a `#` that starts a token
/// begins a comment and a backslash at a line's end joins the next line on; in the plain syntax (PLY) neither is
/// special.
class TextCursor {
 public:
  enum class Syntax { obj, plain };

  /// `text` must outlive the cursor; `file` is the name used in errors.
  TextCursor(std::string_view text, std::string file, Syntax syntax);

  /// Leaves the current line and moves to the next one that holds a token. False at the end of the text.
  bool next_line();
  /// The next token of the line, empty at its end.
  std::string_view token();
  /// What is left of the line, trimmed, without a trailing comment; for names that may hold blanks.
  std::string_view rest();
  /// True if the line holds no further token.
  bool at_line_end();

  /// The next token as a finite number. Throws InputError at the token (or line end) naming `what`.
  double number(std::string_view what);
  /// The same, rounded to float; a number beyond float's range is an error.
  float number_f(std::string_view what);
  /// The next token as an integer in [low, high].
  std::int64_t integer(std::string_view what, std::int64_t low, std::int64_t high);
  /// Throws InputError unless the line ends here.
  void expect_line_end();

  /// Parses `token`, which must be part of the last token read, as a finite number; InputError at its place otherwise.
  double parse_number(std::string_view token, std::string_view what) const;

  /// Byte offset behind the end of the current line, its line break included.
  [[nodiscard]] std::size_t offset_after_line() const;
  /// Bytes from the current position to the end of the text.
  [[nodiscard]] std::size_t remaining() const { return text_.size() - pos_; }

  [[nodiscard]] const std::string& file() const { return file_; }
  /// "file:line:column" of the last token read.
  [[nodiscard]] std::string place() const { return place_at(token_begin_); }
  /// Throws InputError at the last token read.
  [[noreturn]] void fail(std::string_view message) const;
  /// Throws InputError at `part`, a piece of the last token read.
  [[noreturn]] void fail_at(std::string_view part, std::string_view message) const;

 private:
  [[nodiscard]] std::string place_at(std::size_t offset) const;
  [[nodiscard]] std::size_t line_break_length(std::size_t offset) const;
  void skip_blanks();
  void scan_token();

  std::string_view text_;
  std::string file_;
  Syntax syntax_;
  std::size_t pos_ = 0;
  std::size_t line_ = 1;
  std::size_t line_start_ = 0;
  std::size_t token_begin_ = 0;
  std::size_t token_line_ = 1;
  std::size_t token_line_start_ = 0;
  bool started_ = false;
};

}  // namespace hemiray
