// What all modules share: see pellucid/base.h.
#include "pellucid/base.h"

#include "base/platform/platform.h"

namespace pellucid {

void stop_if_requested(const Progress* progress) {
  if (progress != nullptr && progress->stop_requested()) throw Error(ErrorKind::interrupted, "interrupted");
}

std::uint64_t peak_rss_bytes() {
  return platform::peak_rss_bytes();
}

}  // namespace pellucid
