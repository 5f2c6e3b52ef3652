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

// A picture as a data URI, with its caption.
std::string figure(const std::string& caption, std::span<const std::uint8_t> png);

}  // namespace pellucid
