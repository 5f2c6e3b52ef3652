// Parallel loops that end as sequential ones do: everything is done, or something was thrown.
//
// TBB cancels the loops inside a loop when one of its tasks throws, as a stop on request does: they return
// early as if they were done, and what follows works on half of their results. A context of its own keeps a
// loop from that.
#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_group.h>

#include <utility>

namespace pellucid {

// Arguments as those of tbb::parallel_for.
template <class... Arguments>
void parallel_loop(Arguments&&... arguments) {
  tbb::task_group_context own(tbb::task_group_context::isolated);
  tbb::parallel_for(std::forward<Arguments>(arguments)..., own);
}

}  // namespace pellucid
