// Implements the number of threads: max_threads() of parallel.h and ThreadLimit of pellucid/base.h.
#include "base/parallel.h"

#include "pellucid/base.h"

#ifndef PELLUCID_SERIAL
#include <tbb/global_control.h>
#endif

namespace pellucid {

#ifdef PELLUCID_SERIAL

std::size_t max_threads() {
  return 1;
}

namespace {

void* begin_limit(unsigned /*threads*/) {
  return nullptr;
}
void end_limit(void* /*limit*/) {}

}  // namespace

#else

std::size_t max_threads() {
  // The concurrency of the arena does not include the limit of ThreadLimit.
  const auto places = static_cast<std::size_t>(std::max(tbb::this_task_arena::max_concurrency(), 1));
  return std::min(places, tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism));
}

namespace {

void* begin_limit(unsigned threads) {
  if (threads == 0) return nullptr;
  return new tbb::global_control(tbb::global_control::max_allowed_parallelism, threads);
}
void end_limit(void* limit) {
  delete static_cast<tbb::global_control*>(limit);
}

}  // namespace

#endif

ThreadLimit::ThreadLimit(unsigned threads) : control_(begin_limit(threads)) {}

ThreadLimit::~ThreadLimit() {
  end_limit(control_);
}

}  // namespace pellucid
