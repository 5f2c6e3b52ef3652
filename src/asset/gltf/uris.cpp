// Implements uris.h: base64, percent-encoding and the checks of relative references.
#include "asset/gltf/uris.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <system_error>

#include "asset/formats/text_cursor.h"

namespace pellucid {
namespace {

constexpr std::string_view kBase64 = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
constexpr std::uint8_t kNotBase64 = 255;

constexpr std::array<std::uint8_t, 256> base64_values() {
  std::array<std::uint8_t, 256> values{};
  values.fill(kNotBase64);
  for (std::size_t i = 0; i < kBase64.size(); ++i) {
    values[static_cast<unsigned char>(kBase64[i])] = static_cast<std::uint8_t>(i);
  }
  return values;
}

// Decodes base64. Padding is optional, as in browsers. Any other character out of place makes the text
// malformed.
std::optional<Bytes> decode_base64(std::string_view text) {
  static constexpr auto kValues = base64_values();
  while (!text.empty() && text.back() == '=') text.remove_suffix(1);
  if (text.size() % 4 == 1) return std::nullopt;
  Bytes bytes;
  bytes.reserve(text.size() / 4 * 3 + 2);
  std::uint32_t bits = 0;
  unsigned bit_count = 0;
  for (const char c : text) {
    const std::uint8_t value = kValues[static_cast<unsigned char>(c)];
    if (value == kNotBase64) return std::nullopt;
    bits = (bits << 6U) | value;
    bit_count += 6;
    if (bit_count >= 8) {
      bit_count -= 8;
      bytes.push_back(static_cast<std::byte>((bits >> bit_count) & 255U));
    }
  }
  return bytes;
}

std::optional<unsigned> hex_digit(char c) {
  if (c >= '0' && c <= '9') return static_cast<unsigned>(c - '0');
  if (c >= 'a' && c <= 'f') return static_cast<unsigned>(c - 'a' + 10);
  if (c >= 'A' && c <= 'F') return static_cast<unsigned>(c - 'A' + 10);
  return std::nullopt;
}

// Replaces "%41" by "A". A '%' that two hexadecimal digits do not follow stays as it is: many programs write
// names of files without encoding them.
std::string decode_percent(std::string_view text) {
  std::string decoded;
  decoded.reserve(text.size());
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto high = text[i] == '%' && i + 2 < text.size() ? hex_digit(text[i + 1]) : std::nullopt;
    const auto low = high ? hex_digit(text[i + 2]) : std::nullopt;
    decoded.push_back(low ? static_cast<char>(*high * 16 + *low) : text[i]);
    if (low) i += 2;
  }
  return decoded;
}

// Returns whether "scheme:" comes before any '/', '?' or '#'.
bool has_scheme(std::string_view uri) {
  const std::size_t colon = uri.find(':');
  return colon != std::string_view::npos && uri.find_first_of("/?#") > colon;
}

}  // namespace

bool is_data_uri(std::string_view uri) {
  return equals_ignoring_case(uri.substr(0, 5), "data:");
}

std::optional<Bytes> decode_data_uri(std::string_view uri) {
  constexpr std::string_view kBase64Mark = ";base64";
  const std::size_t comma = uri.find(',');
  if (!is_data_uri(uri) || comma == std::string_view::npos) return std::nullopt;
  const std::string_view head = uri.substr(0, comma);
  const std::string data = decode_percent(uri.substr(comma + 1));
  const std::size_t mark = head.size() - std::min(head.size(), kBase64Mark.size());
  if (equals_ignoring_case(head.substr(mark), kBase64Mark)) return decode_base64(data);
  Bytes bytes(data.size());
  std::transform(data.begin(), data.end(), bytes.begin(), [](char c) { return static_cast<std::byte>(c); });
  return bytes;
}

std::string encode_data_uri(const Bytes& bytes) {
  std::string uri = "data:application/octet-stream;base64,";
  uri.reserve(uri.size() + (bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t bits = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      bits = (bits << 8U) | (k < count ? std::to_integer<std::uint32_t>(bytes[i + k]) : 0U);
    }
    for (std::size_t k = 0; k < 4; ++k) {
      uri.push_back(k <= count ? kBase64[(bits >> (18U - 6U * k)) & 63U] : '=');
    }
  }
  return uri;
}

std::optional<std::string> decode_relative_uri(std::string_view uri) {
  if (uri.empty() || uri.front() == '/' || uri.front() == '\\' || has_scheme(uri)) return std::nullopt;
  std::string path = decode_percent(uri);
  if (path.find('\0') != std::string::npos) return std::nullopt;
  // An escaped '/' must not make the path absolute.
  if (path.front() == '/') return std::nullopt;
  return path;
}

std::optional<std::string> relative_path(const std::filesystem::path& folder, std::string_view uri) {
  std::optional<std::string> path = decode_relative_uri(uri);
  if (!path) return path;
  std::error_code ignored;
  // "a%20b.bin" may be the name itself.
  const bool raw = !std::filesystem::exists(folder / *path, ignored) &&
                   std::filesystem::exists(folder / std::string(uri), ignored);
  return raw ? std::string(uri) : path;
}

std::string encode_relative_uri(std::string_view path) {
  constexpr std::string_view kHex = "0123456789ABCDEF";
  std::string uri;
  for (const char c : path) {
    const auto byte = static_cast<unsigned char>(c);
    const bool plain = byte < 128 && (std::isalnum(byte) != 0 ||
                                      std::string_view("-._~/").find(c) != std::string_view::npos);
    if (plain) {
      uri.push_back(c);
    } else {
      uri.push_back('%');
      uri.push_back(kHex[byte >> 4U]);
      uri.push_back(kHex[byte & 15U]);
    }
  }
  return uri;
}

}  // namespace pellucid
