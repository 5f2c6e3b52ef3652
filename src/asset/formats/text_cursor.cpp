// Implements text_cursor.h: words and numbers of a text file.
#include "asset/formats/text_cursor.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

namespace pellucid {
namespace {

bool is_blank(char c) {
  return c == ' ' || c == '\t' || c == '\v' || c == '\f';
}

bool is_line_end(char c) {
  return c == '\n' || c == '\r';
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

// Returns the value of a word that the C library of older Microsoft compilers prints: "1.#INF", "-1.#IND00",
// "1.#QNAN", and "1.#J", which is "1.#INF" rounded to one digit.
std::optional<double> microsoft_word(std::string_view text) {
  const bool negative = text.starts_with('-');
  if (negative) text.remove_prefix(1);
  if (!text.starts_with("1.#")) return {};
  text.remove_prefix(3);
  const double infinity = std::numeric_limits<double>::infinity();
  if (text.starts_with("INF") || text.starts_with('J')) return negative ? -infinity : infinity;
  if (text.starts_with("IND") || text.starts_with("QNAN") || text.starts_with("SNAN"))
    return std::numeric_limits<double>::quiet_NaN();
  return {};
}

}  // namespace

std::optional<double> parse_double(std::string_view text) {
  text = without_plus(text);
  double value = 0;
  const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (status == std::errc::invalid_argument || end != text.data() + text.size()) return microsoft_word(text);
  return status == std::errc::result_out_of_range ? beyond_double(text) : value;
}

std::optional<float> parse_float(std::string_view text) {
  text = without_plus(text);
  float value = 0;
  const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (status == std::errc::invalid_argument || end != text.data() + text.size()) {
    const std::optional<double> word = microsoft_word(text);
    return word ? std::optional(static_cast<float>(*word)) : std::nullopt;
  }
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

std::string_view unquoted(std::string_view name) {
  while (!name.empty() && is_blank(name.front())) name.remove_prefix(1);
  while (!name.empty() && is_blank(name.back())) name.remove_suffix(1);
  const bool quoted = name.size() >= 2 && name.front() == name.back() && name.front() == '"';
  return quoted ? name.substr(1, name.size() - 2) : name;
}

bool equals_ignoring_case(std::string_view a, std::string_view b) {
  const auto lower = [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; };
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [&](char p, char q) { return lower(p) == lower(q); });
}

TextCursor::TextCursor(std::string path, std::string_view text, char comment)
    : path_(std::move(path)), text_(text), comment_(comment) {
  if (text_.starts_with("\xEF\xBB\xBF")) at_ = 3;
  if (text_.starts_with("\xFF\xFE") || text_.starts_with("\xFE\xFF"))
    throw Error(ErrorKind::bad_input, path_ + ": the text is UTF-16; save it as UTF-8 or ASCII");
}

bool TextCursor::at_continuation() const {
  return text_[at_] == '\\' && at_ + 1 < text_.size() && is_line_end(text_[at_ + 1]);
}

void TextCursor::go_to_line_end() {
  while (at_ < text_.size() && !is_line_end(text_[at_])) ++at_;
}

// Skips blanks, continued line ends, and comments, but not the end of the line.
void TextCursor::skip_blanks() {
  while (at_ < text_.size()) {
    if (is_blank(text_[at_])) {
      ++at_;
    } else if (at_continuation()) {
      skip_line();
    } else if (comment_ != '\0' && text_[at_] == comment_) {
      go_to_line_end();
    } else {
      return;
    }
  }
}

std::string_view TextCursor::take_word() {
  const std::size_t begin = at_;
  while (at_ < text_.size() && !is_line_end(text_[at_]) && !is_blank(text_[at_]) && !at_continuation()) ++at_;
  return text_.substr(begin, at_ - begin);
}

std::string_view TextCursor::token_on_line() {
  skip_blanks();
  return take_word();
}

bool TextCursor::has_more() {
  for (;;) {
    skip_blanks();
    if (at_ >= text_.size() || !is_line_end(text_[at_])) return at_ < text_.size();
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
  go_to_line_end();
  std::string_view rest = text_.substr(begin, at_ - begin);
  while (!rest.empty() && is_blank(rest.back())) rest.remove_suffix(1);
  return rest;
}

void TextCursor::skip_line() {
  go_to_line_end();
  if (at_ >= text_.size()) return;
  at_ += text_.substr(at_).starts_with("\r\n") ? 2U : 1U;
  ++line_;
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
