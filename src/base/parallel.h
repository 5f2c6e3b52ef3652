// Loops, sorts and objects for several threads. Only this file and parallel.cpp use oneTBB; where
// PELLUCID_SERIAL is defined, nothing uses it, and everything runs on the calling thread with the same
// results.
#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>
#include <optional>
#include <utility>

#ifndef PELLUCID_SERIAL
#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>
#include <tbb/partitioner.h>
#include <tbb/task_arena.h>
#include <tbb/task_group.h>
#endif

namespace pellucid {

// How several threads divide the loop of parallel_ranges(): both ways halve ranges that are longer than the
// grain.
enum class Partitioner {
  automatic,  // only as often as it takes to keep the threads busy
  simple,     // until none is left, for any number of threads
};

// Returns how many threads work at the same time at most: 1 or more.
std::size_t max_threads();

// Calls body(i) for every i of begin .. end - 1. What a body throws reaches the caller once no other body
// runs. A loop inside another one ends as a sequential loop does: it is complete or throws, whatever is
// thrown elsewhere.
template <class Index, class Body>
void parallel_loop(Index begin, Index end, const Body& body);

// Calls body(range_begin, range_end) for ranges that together are begin .. end - 1. None is empty or shorter
// than half the grain, unless the whole loop is. Otherwise as parallel_loop().
template <class Index, class Body>
void parallel_ranges(Index begin, Index end, std::size_t grain, const Body& body,
                     Partitioner partitioner = Partitioner::automatic);

// Sorts a range with random access. The order of elements that compare equal depends on the number of
// threads: results are the same for any number only where nothing tells such elements apart.
template <class Iterator, class Less = std::less<>>
void parallel_sort(Iterator begin, Iterator end, const Less& less = Less());

// Calls function(). While the calling thread waits there for a loop to end, it takes no work of loops
// outside. It might otherwise begin another body of the loop that it is in, which uses the same PerThread
// objects.
template <class Function>
void run_isolated(const Function& function);

// Objects of which each thread has its own, such as working memory. A thread's object is made when the thread
// first asks for it with local(): by make(), which several threads may call at once, or by T(). Which objects
// there are in the end depends on the threads; results must not.
template <class T>
class PerThread;

#ifdef PELLUCID_SERIAL

// ------------------------------------------------------------------------------------------- one thread

template <class Index, class Body>
void parallel_loop(Index begin, Index end, const Body& body) {
  for (Index i = begin; i < end; ++i) body(i);
}

template <class Index, class Body>
void parallel_ranges(Index begin, Index end, std::size_t /*grain*/, const Body& body,
                     Partitioner /*partitioner*/) {
  if (begin < end) body(begin, end);
}

template <class Iterator, class Less>
void parallel_sort(Iterator begin, Iterator end, const Less& less) {
  std::sort(begin, end, less);
}

template <class Function>
void run_isolated(const Function& function) {
  function();
}

template <class T>
class PerThread {
 public:
  PerThread() : PerThread([] { return T(); }) {}
  explicit PerThread(std::function<T()> make) : make_(std::move(make)) {}

  [[nodiscard]] T& local() {
    if (!object_) object_.emplace(make_());
    return *object_;
  }

 private:
  std::function<T()> make_;
  std::optional<T> object_;
};

#else

// --------------------------------------------------------------------------------------- several threads

// TBB cancels the loops inside a loop when one of its tasks throws, as a stop on request does: they return
// early as if they were done, and what follows works on half of their results. The isolated context that each
// loop has here keeps it from that.

template <class Index, class Body>
void parallel_loop(Index begin, Index end, const Body& body) {
  tbb::task_group_context own(tbb::task_group_context::isolated);
  tbb::parallel_for(begin, end, body, own);
}

template <class Index, class Body>
void parallel_ranges(Index begin, Index end, std::size_t grain, const Body& body, Partitioner partitioner) {
  using Range = tbb::blocked_range<Index>;
  const auto call = [&body](const Range& range) { body(range.begin(), range.end()); };
  const Range all(begin, end, grain);
  tbb::task_group_context own(tbb::task_group_context::isolated);
  if (partitioner == Partitioner::simple) {
    tbb::parallel_for(all, call, tbb::simple_partitioner(), own);
  } else {
    tbb::parallel_for(all, call, tbb::auto_partitioner(), own);
  }
}

template <class Iterator, class Less>
void parallel_sort(Iterator begin, Iterator end, const Less& less) {
  // tbb::parallel_sort takes no context. It inherits that of the loop around it.
  parallel_loop(0, 1, [&](int) { tbb::parallel_sort(begin, end, less); });
}

template <class Function>
void run_isolated(const Function& function) {
  tbb::this_task_arena::isolate(function);
}

template <class T>
class PerThread {
 public:
  PerThread() = default;
  explicit PerThread(std::function<T()> make) : objects_(std::move(make)) {}

  [[nodiscard]] T& local() { return objects_.local(); }

 private:
  tbb::enumerable_thread_specific<T> objects_;
};

#endif

}  // namespace pellucid
