// Implements text_cursor.h: words and numbers of a text file.
#include "asset/formats/text_cursor.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

namespace pellucid {
namespace {

bool is_blank(char c) {
  return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f';
}

std::string_view without_plus(std::string_view text) {
  // "+-1" is not a number.
  if (text.size() > 1 && text[0] == '+' && text[1] != '-' && text[1] != '+') text.remove_prefix(1);
  return text;
}

// Returns infinity or zero for a decimal number that no double can hold. from_chars only reports that it is
// out of range.
double beyond_double(std::string_view text) {
  const bool negative = text.front() == '-';
  const std::size_t exponent = text.find_first_of("eE");
  bool small = false;
  if (exponent == std::string_view::npos) {
    small = text.substr(0, text.find('.')).find_first_of("123456789") == std::string_view::npos;
  } else {
    small = text.substr(exponent + 1).starts_with('-');
  }
  const double size = small ? 0.0 : std::numeric_limits<double>::infinity();
  return negative ? -size : size;
}

}  // namespace

std::optional<double> parse_double(std::string_view text) {
  text = without_plus(text);
  double value = 0;
  const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (status == std::errc::invalid_argument || end != text.data() + text.size()) return {};
  return status == std::errc::result_out_of_range ? beyond_double(text) : value;
}

std::optional<float> parse_float(std::string_view text) {
  text = without_plus(text);
  float value = 0;
  const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (status == std::errc::invalid_argument || end != text.data() + text.size()) return {};
  if (status != std::errc::result_out_of_range) return value;
  const double wide = parse_double(text).value_or(0.0);
  const float size = std::fabs(wide) > 1.0 ? std::numeric_limits<float>::infinity() : 0.0F;
  return std::copysign(size, static_cast<float>(std::copysign(1.0, wide)));
}

std::optional<std::int64_t> parse_integer(std::string_view text) {
  text = without_plus(text);
  std::int64_t value = 0;
  const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (status != std::errc() || end != text.data() + text.size()) return {};
  return value;
}

std::string in_quotes(std::string_view text, std::size_t longest) {
  const auto is_control = [](char c) { return (c >= 0 && c < ' ') || c == '\x7F'; };
  std::string result = "'";
  for (const char c : text.substr(0, longest)) result += is_control(c) ? '?' : c;
  return result + (text.size() > longest ? "...'" : "'");
}

bool TextCursor::at_continuation() const {
  const std::string_view rest = text_.substr(at_);
  return rest.starts_with("\\\n") || rest.starts_with("\\\r\n");
}

// Skips blanks, continued line ends, and comments, but not the end of the line.
void TextCursor::skip_blanks() {
  while (at_ < text_.size()) {
    if (is_blank(text_[at_])) {
      ++at_;
    } else if (at_continuation()) {
      skip_line();
    } else if (comment_ != '\0' && text_[at_] == comment_) {
      at_ = std::min(text_.find('\n', at_), text_.size());
    } else {
      return;
    }
  }
}

std::string_view TextCursor::take_word() {
  const std::size_t begin = at_;
  while (at_ < text_.size() && text_[at_] != '\n' && !is_blank(text_[at_]) && !at_continuation()) ++at_;
  return text_.substr(begin, at_ - begin);
}

std::string_view TextCursor::token_on_line() {
  skip_blanks();
  return take_word();
}

bool TextCursor::has_more() {
  for (;;) {
    skip_blanks();
    if (at_ >= text_.size() || text_[at_] != '\n') return at_ < text_.size();
    skip_line();
  }
}

std::string_view TextCursor::token() {
  has_more();
  return take_word();
}

std::string_view TextCursor::rest_of_line() {
  while (at_ < text_.size() && is_blank(text_[at_])) ++at_;
  const std::size_t begin = at_;
  at_ = std::min(text_.find('\n', at_), text_.size());
  std::string_view rest = text_.substr(begin, at_ - begin);
  while (!rest.empty() && is_blank(rest.back())) rest.remove_suffix(1);
  return rest;
}

void TextCursor::skip_line() {
  const std::size_t end = text_.find('\n', at_);
  if (end == std::string_view::npos) {
    at_ = text_.size();
  } else {
    at_ = end + 1;
    ++line_;
  }
}

float TextCursor::read_float(std::string_view what) {
  const std::string_view word = token();
  if (const std::optional<float> value = parse_float(word)) return *value;
  throw unexpected(what, word);
}

double TextCursor::read_double(std::string_view what) {
  const std::string_view word = token();
  if (const std::optional<double> value = parse_double(word)) return *value;
  throw unexpected(what, word);
}

std::int64_t TextCursor::read_integer(std::string_view what) {
  const std::string_view word = token();
  if (const std::optional<std::int64_t> value = parse_integer(word)) return *value;
  throw unexpected(what, word);
}

Error TextCursor::error(const std::string& reason) const {
  return {ErrorKind::bad_input, path_ + ": line " + std::to_string(line_) + ": " + reason};
}

Error TextCursor::unexpected(std::string_view what, std::string_view found) const {
  if (found.empty()) return error("the file ends where " + std::string(what) + " should be");
  return error("expected " + std::string(what) + ", found " + in_quotes(found));
}

}  // namespace pellucid
