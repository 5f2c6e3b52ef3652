// What all report pages share: their look, and the parts that they are put together from. All text is escaped
// here; `content` is markup.
#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace pellucid {

// A whole page: no network, the reader's light or dark scheme.
std::string html_page(const std::string& title, const std::string& content);

// A number and what it says, for <div class="tiles">.
std::string tile(const std::string& value, const std::string& label);

// Where a table has no value: an en dash.
constexpr const char* kNoValue = "\u2013";

// "1 frame", "12,000 frames".
std::string plural(std::uint64_t count, const std::string& word);

// A picture as a data URI, with its caption. `attributes` of the picture: markup; `below` the caption:
// markup.
std::string figure(const std::string& caption, std::span<const std::uint8_t> png,
                   const std::string& attributes = "", const std::string& below = "");

}  // namespace pellucid
