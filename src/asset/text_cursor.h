// Internal to the module `asset`: a cursor over the text of a model file that knows its line and never reads
// past the end. Numbers are read with std::from_chars: no locale, nearest float.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "pellucid/base.h"

namespace pellucid {

// "1.5", "+2", "-inf", "nan"; values beyond the type's range become infinite or zero, as on the way to
// float32 in any other program. Empty where `text` is not wholly a number.
std::optional<float> parse_float(std::string_view text);
std::optional<double> parse_double(std::string_view text);
// A whole decimal number, maybe signed, that fits.
std::optional<std::int64_t> parse_integer(std::string_view text);

class TextCursor {
 public:
  // `comment`: from this character to the end of its line is skipped; '\0': there are no comments.
  TextCursor(std::string path, std::string_view text, char comment)
      : path_(std::move(path)), text_(text), comment_(comment) {}

  // Whether another word follows; the cursor moves to it.
  bool has_more();
  // Next word of the text; empty at its end.
  std::string_view token();
  // Next word of this line; empty at its end. A backslash before the line's end continues the line.
  std::string_view token_on_line();
  // What is left of this line, without blanks at either end; the cursor stays on the line.
  std::string_view rest_of_line();
  // To the beginning of the next line.
  void skip_line();

  // A number as the next word of the text. Throws Error naming the line, `what` is missing or what stands
  // there.
  float read_float(std::string_view what);
  double read_double(std::string_view what);
  std::int64_t read_integer(std::string_view what);

  [[nodiscard]] bool at_end() const { return at_ >= text_.size(); }
  [[nodiscard]] std::uint64_t line() const { return line_; }
  [[nodiscard]] std::size_t remaining() const { return text_.size() - at_; }
  // Error{bad_input}: "path: line N: reason".
  [[nodiscard]] Error error(const std::string& reason) const;
  // The same where the file ended too soon, or where `found` stands instead of `what`.
  [[nodiscard]] Error unexpected(std::string_view what, std::string_view found) const;

 private:
  [[nodiscard]] bool at_continuation() const;
  void skip_blanks();
  std::string_view take_word();

  std::string path_;
  std::string_view text_;
  char comment_;
  std::size_t at_ = 0;
  std::uint64_t line_ = 1;
};

// Text of a file for messages: without control characters, and cut where it is long.
std::string in_quotes(std::string_view text, std::size_t longest = 40);

}  // namespace pellucid
