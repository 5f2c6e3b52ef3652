// Tests parallel.h, both the version for several threads and the serial one.
#include "base/parallel.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "pellucid/base.h"

namespace pellucid {
namespace {

constexpr std::size_t kSizes[] = {0, 1, 2, 7, 100, 1000, 12345};

std::vector<std::uint64_t> random_numbers(std::size_t count, std::uint64_t below) {
  Random random(count);
  std::vector<std::uint64_t> numbers(count);
  for (std::uint64_t& number : numbers) number = random.below(below);
  return numbers;
}

TEST(ParallelLoop, VisitsEveryIndexOnce) {
  for (const std::size_t size : kSizes) {
    for (const std::size_t begin : {std::size_t{0}, std::size_t{5}}) {
      std::vector<std::atomic<int>> visits(begin + size);
      parallel_loop(begin, begin + size, [&](std::size_t i) { ++visits[i]; });
      for (std::size_t i = 0; i < visits.size(); ++i)
        ASSERT_EQ(visits[i], i < begin ? 0 : 1) << size << " " << i;
    }
  }
}

TEST(ParallelRanges, VisitEveryIndexOnceInRangesOfAtLeastHalfAGrain) {
  for (const Partitioner partitioner : {Partitioner::automatic, Partitioner::simple}) {
    for (const std::size_t size : kSizes) {
      for (const std::size_t grain : {1U, 3U, 64U, 5000U}) {
        std::vector<std::atomic<int>> visits(size);
        std::atomic<std::size_t> shortest{size};
        const auto visit = [&](std::uint32_t begin, std::uint32_t end) {
          for (std::uint32_t i = begin; i < end; ++i) ++visits[i];
          std::size_t known = shortest;
          while (end - begin < known && !shortest.compare_exchange_weak(known, end - begin)) {
          }
        };
        parallel_ranges(std::uint32_t{0}, static_cast<std::uint32_t>(size), grain, visit, partitioner);
        for (const std::atomic<int>& count : visits) ASSERT_EQ(count, 1) << size << " " << grain;
        EXPECT_GE(shortest, std::min(size, (grain + 1) / 2)) << size << " " << grain;
      }
    }
  }
}

TEST(ParallelRanges, CallNoBodyForAnEmptyRange) {
  parallel_ranges(3, 3, 1, [](int, int) { FAIL(); });
}

TEST(ParallelLoop, RethrowsTheExceptionOfABodyAfterAllBodiesReturned) {
  for (int repetition = 0; repetition < 100; ++repetition) {
    std::atomic<bool> returned{false};
    std::atomic<int> late{0};
    const auto body = [&](int i) {
      if (i == 500) throw std::runtime_error("five hundred");
      if (i % 50 == 0) std::this_thread::yield();
      if (returned) ++late;
    };
    std::string what;
    try {
      parallel_loop(0, 1000, body);
    } catch (const std::runtime_error& error) {
      what = error.what();
    }
    returned = true;
    EXPECT_EQ(what, "five hundred");
    std::this_thread::yield();
    EXPECT_EQ(late, 0);
  }
}

TEST(ParallelRanges, RethrowTheExceptionOfABody) {
  const auto body = [](int begin, int end) {
    if (begin <= 500 && 500 < end) throw std::runtime_error("five hundred");
  };
  for (const Partitioner partitioner : {Partitioner::automatic, Partitioner::simple})
    EXPECT_THROW(parallel_ranges(0, 1000, 10, body, partitioner), std::runtime_error);
}

// Every outer body runs a loop of its own, while one outer body throws.
TEST(ParallelLoop, CompletesInsideALoopWhoseOtherBodyThrows) {
  constexpr int kOuter = 16;
  constexpr int kInner = 2000;
  for (int repetition = 0; repetition < 20; ++repetition) {
    std::atomic<int> incomplete{0};
    std::atomic<int> unsorted{0};
    const auto outer = [&](int i) {
      if (i == repetition % kOuter) throw std::runtime_error("sibling");
      std::atomic<int> visited{0};
      parallel_loop(0, kInner, [&](int) { ++visited; });
      parallel_ranges(0, kInner, 8, [&](int begin, int end) { visited += end - begin; });
      if (visited != 2 * kInner) ++incomplete;
      std::vector<std::uint64_t> numbers = random_numbers(kInner, 1000);
      parallel_sort(numbers.begin(), numbers.end());
      if (!std::is_sorted(numbers.begin(), numbers.end())) ++unsorted;
    };
    EXPECT_THROW(parallel_loop(0, kOuter, outer), std::runtime_error);
    EXPECT_EQ(incomplete, 0);
    EXPECT_EQ(unsorted, 0);
  }
}

TEST(ParallelSort, SortsAsTheStandardLibrary) {
  for (const std::size_t size : {0U, 1U, 2U, 499U, 500U, 501U, 20'000U}) {
    for (const std::uint64_t below : {std::uint64_t{10}, std::uint64_t{1} << 60U}) {
      const std::vector<std::uint64_t> numbers = random_numbers(size, below);
      std::vector<std::uint64_t> expected = numbers;
      std::vector<std::uint64_t> actual = numbers;
      std::sort(expected.begin(), expected.end());
      parallel_sort(actual.begin(), actual.end());
      EXPECT_EQ(actual, expected);
      std::sort(expected.begin(), expected.end(), std::greater<>());
      parallel_sort(actual.begin(), actual.end(), std::greater<>());
      EXPECT_EQ(actual, expected);
    }
  }
}

TEST(RunIsolated, RunsNoOtherBodyOfTheOuterLoop) {
  PerThread<bool> busy;
  std::atomic<int> intrusions{0};
  parallel_loop(0, 50, [&](int) {
    bool& is_busy = busy.local();
    if (is_busy) ++intrusions;
    is_busy = true;
    run_isolated([] {
      parallel_loop(0, 50, [](int) { std::this_thread::sleep_for(std::chrono::microseconds(20)); });
    });
    is_busy = false;
  });
  EXPECT_EQ(intrusions, 0);
}

TEST(RunIsolated, RethrowsExceptions) {
  EXPECT_THROW(run_isolated([] { throw std::runtime_error("inside"); }), std::runtime_error);
}

struct Owned {
  std::thread::id owner = std::this_thread::get_id();
};

TEST(PerThread, GivesEachThreadItsOwnObject) {
  PerThread<Owned> objects;
  std::atomic<int> strangers{0};
  parallel_loop(0, 10'000, [&](int) {
    if (objects.local().owner != std::this_thread::get_id()) ++strangers;
  });
  EXPECT_EQ(strangers, 0);
}

TEST(PerThread, CreatesObjectsOnFirstUse) {
  std::atomic<int> made{0};
  PerThread<int> numbers([&] {
    ++made;
    return 17;
  });
  EXPECT_EQ(made, 0);
  EXPECT_EQ(numbers.local(), 17);
  numbers.local() = 18;
  EXPECT_EQ(numbers.local(), 18);
  EXPECT_EQ(made, 1);
}

TEST(ThreadLimit, BoundsTheNumberOfThreads) {
  const std::size_t all = max_threads();
  EXPECT_GE(all, 1U);
  {
    const ThreadLimit none(0);
    EXPECT_EQ(max_threads(), all);
    const ThreadLimit one(1);
    EXPECT_EQ(max_threads(), 1U);
    const std::thread::id own = std::this_thread::get_id();
    std::atomic<int> elsewhere{0};
    parallel_loop(0, 10'000, [&](int) { elsewhere += std::this_thread::get_id() == own ? 0 : 1; });
    EXPECT_EQ(elsewhere, 0);
  }
  EXPECT_EQ(max_threads(), all);
}

#ifdef PELLUCID_SERIAL
TEST(Serial, HasOneThread) {
  EXPECT_EQ(max_threads(), 1U);
}
#endif

}  // namespace
}  // namespace pellucid
