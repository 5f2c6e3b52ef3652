// What every room shares: see pellucid/base.h.
#include "pellucid/base.h"

#include <sys/resource.h>
#include <tbb/global_control.h>

namespace pellucid {

void stop_if_requested(const Progress* progress) {
  if (progress != nullptr && progress->stop_requested()) throw Error(ErrorKind::interrupted, "interrupted");
}

std::uint64_t peak_rss_bytes() {
  rusage usage{};
  if (getrusage(RUSAGE_SELF, &usage) != 0) return 0;
  return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024U;  // Linux reports kibibytes.
}

ThreadLimit::ThreadLimit(unsigned threads)
    : control_(threads == 0
                   ? nullptr
                   : new tbb::global_control(tbb::global_control::max_allowed_parallelism, threads)) {}

ThreadLimit::~ThreadLimit() {
  delete static_cast<tbb::global_control*>(control_);
}

}  // namespace pellucid
