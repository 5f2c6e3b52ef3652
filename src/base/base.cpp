// Implements the small functions of pellucid/base.h. Files are in file.cpp, and ThreadLimit is in
// parallel.cpp.
#include "pellucid/base.h"

#include <algorithm>

#include "base/platform/platform.h"

namespace pellucid {

void stop_if_requested(const Progress* progress) {
  if (progress != nullptr && progress->stop_requested()) throw Error(ErrorKind::interrupted, "interrupted");
}

std::uint64_t peak_rss_bytes() {
  return platform::peak_rss_bytes();
}

std::vector<std::string> text_lines(std::string_view text) {
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  std::vector<std::string> lines;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find_first_of("\r\n"), text.size());
    lines.emplace_back(text.substr(0, end));
    const std::string_view rest = text.substr(end);
    text = rest.substr(rest.starts_with("\r\n") ? 2 : std::min<std::size_t>(rest.size(), 1));
  }
  return lines;
}

std::string format_count(std::uint64_t count) {
  std::string digits = std::to_string(count);
  for (std::size_t i = digits.size(); i > 3; i -= 3) digits.insert(i - 3, 1, ',');
  return digits;
}

}  // namespace pellucid
