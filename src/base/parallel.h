// Parallel loops, parallel sorting and objects per thread. Only this file and parallel.cpp use oneTBB. With
// PELLUCID_SERIAL defined, oneTBB is not needed, and everything runs on the calling thread with the same
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

// How parallel_ranges() divides a loop. Both kinds halve ranges that are longer than the grain.
enum class Partitioner {
  automatic,  // halves only as often as needed to keep the threads busy
  simple,     // halves until no range is longer than the grain, whatever the number of threads
};

// Returns the largest number of threads that work at the same time, which is at least 1.
std::size_t max_threads();

// Calls body(i) for every i of begin .. end - 1. An exception from a body reaches the caller after all
// running bodies have returned. A nested loop behaves like a sequential loop: it completes or throws,
// whatever is thrown outside of it.
template <class Index, class Body>
void parallel_loop(Index begin, Index end, const Body& body);

// Calls body(range_begin, range_end) for disjoint ranges whose union is begin .. end - 1. No range is empty.
// Each one is at least half a grain long, unless the whole loop is shorter. Exceptions are handled as by
// parallel_loop().
template <class Index, class Body>
void parallel_ranges(Index begin, Index end, std::size_t grain, const Body& body,
                     Partitioner partitioner = Partitioner::automatic);

// Sorts a range of random-access iterators. The order of elements that compare equal depends on the number of
// threads. The caller must therefore compare every member that can differ, if results must not depend on it.
template <class Iterator, class Less = std::less<>>
void parallel_sort(Iterator begin, Iterator end, const Less& less = Less());

// Calls function(). While the calling thread waits inside for a loop to end, it takes no work from outer
// loops. Otherwise it could begin another body of the outer loop, which uses the same PerThread objects.
template <class Function>
void run_isolated(const Function& function);

// Gives each thread an object of its own, such as working memory. A thread's first call of local() creates
// its object with make() or T(); several threads may call make() at once. The number of objects depends on
// the threads, but results must not depend on it.
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

// When a task of a loop throws, for example Error{interrupted}, oneTBB cancels the loops nested in it. These
// return early as if they were complete, and the code after them would work on partial results. Each loop
// here has an isolated context, which prevents this cancellation.

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
  // tbb::parallel_sort takes no context; it inherits the one of the loop around it.
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
