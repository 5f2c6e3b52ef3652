// Makes what all report pages share: their frame, their style, and the parts that they are made of. In: text,
// which is escaped here, and images; `content` is markup. Out: HTML.
#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace pellucid {

// Returns a whole page, which needs no network and follows the light or dark scheme of the reader.
std::string html_page(const std::string& title, const std::string& content);

// Returns a number with its label, for <div class="tiles">.
std::string tile(const std::string& value, const std::string& label);

// An en dash, which tables show in place of a missing value.
constexpr const char* kNoValue = "\u2013";

// Returns "1 frame" or "12,000 frames".
std::string plural(std::uint64_t count, const std::string& word);

// Returns an image as a data URI, with its caption. `attributes` (of the image) and `below` (what follows the
// caption) are markup.
std::string figure(const std::string& caption, std::span<const std::uint8_t> png,
                   const std::string& attributes = "", const std::string& below = "");

}  // namespace pellucid
