// Internal to the module `asset`: a cursor over the text of a model file. It returns words and numbers, keeps
// track of the line number, and never reads past the end. A byte order mark of UTF-8 is skipped. LF, CR and
// CRLF each end a line, also in one file. Numbers are read with std::from_chars, so they do not depend on the
// locale and become the nearest float.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "pellucid/base.h"

namespace pellucid {

// Parses "1.5", "+2", "-inf", "nan", and the words that older programs for Windows print for infinity and NaN
// ("1.#INF", "-1.#IND00"). A value beyond the range of the type becomes infinite or zero, as in other
// programs that convert to float32. Returns nothing if `text` is not a number as a whole.
std::optional<float> parse_float(std::string_view text);
std::optional<double> parse_double(std::string_view text);
// Parses a decimal integer with or without a sign. Returns nothing if it does not fit.
std::optional<std::int64_t> parse_integer(std::string_view text);

class TextCursor {
 public:
  // Everything from the character `comment` to the end of its line is skipped; '\0' means that there are no
  // comments. Throws Error{bad_input} for text in UTF-16.
  TextCursor(std::string path, std::string_view text, char comment);

  // Moves to the next word of the text. Returns whether there is one.
  bool has_more();
  // Returns the next word of the text; empty at its end.
  std::string_view token();
  // Returns the next word of this line; empty at its end. A backslash before the line's end continues the
  // line.
  std::string_view token_on_line();
  // Returns the rest of this line without blanks at either end, and stays on the line.
  std::string_view rest_of_line();
  // Moves to the beginning of the next line.
  void skip_line();

  // Reads the next word of the text as a number. Throws Error{bad_input} that names the line, the missing
  // `what`, and what is there instead.
  float read_float(std::string_view what);
  double read_double(std::string_view what);
  std::int64_t read_integer(std::string_view what);

  [[nodiscard]] bool at_end() const { return at_ >= text_.size(); }
  [[nodiscard]] std::uint64_t line() const { return line_; }
  [[nodiscard]] std::size_t remaining() const { return text_.size() - at_; }
  // Returns Error{bad_input} with the text "path: line N: reason".
  [[nodiscard]] Error error(const std::string& reason) const;
  // Returns the same for a file that ends too soon (`found` is empty), or that has `found` in place of
  // `what`.
  [[nodiscard]] Error unexpected(std::string_view what, std::string_view found) const;

 private:
  [[nodiscard]] bool at_continuation() const;
  void go_to_line_end();
  void skip_blanks();
  std::string_view take_word();

  std::string path_;
  std::string_view text_;
  char comment_;
  std::size_t at_ = 0;
  std::uint64_t line_ = 1;
};

// Returns a name without blanks and quotation marks around it.
std::string_view unquoted(std::string_view name);

// Returns whether two words differ at most in upper and lower case (of ASCII).
bool equals_ignoring_case(std::string_view a, std::string_view b);

// Returns text of a file for messages: in quotes, without control characters, and cut if it is long.
std::string in_quotes(std::string_view text, std::size_t longest = 40);

}  // namespace pellucid
