// Implements the small functions of pellucid/base.h. Files are in file.cpp, and ThreadLimit is in
// parallel.cpp.
#include "pellucid/base.h"

#include "base/platform/platform.h"

namespace pellucid {

void stop_if_requested(const Progress* progress) {
  if (progress != nullptr && progress->stop_requested()) throw Error(ErrorKind::interrupted, "interrupted");
}

std::uint64_t peak_rss_bytes() {
  return platform::peak_rss_bytes();
}

std::string format_count(std::uint64_t count) {
  std::string digits = std::to_string(count);
  for (std::size_t i = digits.size(); i > 3; i -= 3) digits.insert(i - 3, 1, ',');
  return digits;
}

}  // namespace pellucid
