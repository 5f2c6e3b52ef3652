// Tests the interface to the operating system: files, locks, memory, time and signals.
#include "base/platform/platform.h"

#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <functional>
#include <system_error>
#include <thread>
#include <vector>

#include "temporary_folder.h"

namespace pellucid::platform {
namespace {

namespace fs = std::filesystem;
using pellucid::testing::slurp;
using pellucid::testing::spill;
using pellucid::testing::TemporaryFolder;

// Returns the reason with which `work` fails, or no error.
std::error_code reason_of(const std::function<void()>& work) {
  try {
    work();
  } catch (const std::system_error& error) {
    return error.code();
  }
  return {};
}

std::array<std::byte, 8> eight_bytes(int first) {
  std::array<std::byte, 8> bytes{};
  for (std::size_t i = 0; i < bytes.size(); ++i)
    bytes[i] = static_cast<std::byte>(first + static_cast<int>(i));
  return bytes;
}

// Keeps the processor busy until `seconds` of wall time have passed.
void work_for(double seconds) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
  volatile unsigned sink = 0;
  while (std::chrono::steady_clock::now() < end) sink = sink + 1;
}

TEST(PlatformPath, ComesBackAsTheSameString) {
  const std::u8string utf8 = u8"Modèle/立方体.glb";
  const std::string name(utf8.begin(), utf8.end());
  EXPECT_EQ(to_utf8(to_path(name)), name);
  EXPECT_TRUE(to_path(name).u8string() == utf8);
}

TEST(PlatformFileKind, DistinguishesFilesFoldersDevicesAndMissingPaths) {
  const TemporaryFolder folder;
  spill(folder.path("file"), "text");
  EXPECT_EQ(file_kind(folder.path("file")), FileKind::regular);
  EXPECT_EQ(file_kind(folder.path()), FileKind::folder);
  EXPECT_EQ(file_kind(folder.path("missing")), FileKind::missing);
  EXPECT_EQ(file_kind(folder.path("file/below")), FileKind::missing);
#ifdef _WIN32
  EXPECT_EQ(file_kind("NUL"), FileKind::device);
#else
  EXPECT_EQ(file_kind("/dev/null"), FileKind::device);
#endif
}

TEST(PlatformWriteRefusal, PermitsOwnFilesAndFoldersAndReportsMissingOnes) {
  const TemporaryFolder folder;
  spill(folder.path("file"), "text");
  EXPECT_FALSE(write_refusal(folder.path("file")));
  EXPECT_FALSE(write_refusal(folder.path()));
  EXPECT_EQ(write_refusal(folder.path("missing")), std::errc::no_such_file_or_directory);
  EXPECT_EQ(slurp(folder.path("file")), "text");  // asking does not change the file
}

TEST(PlatformFolder, IsRemovedOnlyWhenItIsEmpty) {
  const TemporaryFolder folder;
  const std::string inner = folder.path("inner");
  fs::create_directory(to_path(inner));
  spill(inner + "/file", "text");
  remove_empty_folder(inner);
  EXPECT_EQ(slurp(inner + "/file"), "text");
  fs::remove(to_path(inner + "/file"));
  remove_empty_folder(inner);
  EXPECT_EQ(file_kind(inner), FileKind::missing);
  spill(folder.path("file"), "text");
  remove_empty_folder(folder.path("file"));
  EXPECT_EQ(file_kind(folder.path("file")), FileKind::regular);
}

TEST(PlatformFile, IsCreatedOnlyIfItDoesNotExist) {
  const TemporaryFolder folder;
  spill(folder.path("file"), "old");
  EXPECT_EQ(reason_of([&] { File::create_new(folder.path("file")); }), std::errc::file_exists);
  EXPECT_EQ(slurp(folder.path("file")), "old");
  EXPECT_EQ(reason_of([&] { File::create_new(folder.path("new")); }), std::error_code());
  EXPECT_EQ(file_kind(folder.path("new")), FileKind::regular);
}

TEST(PlatformFile, DoesNotReadFoldersOrMissingFiles) {
  const TemporaryFolder folder;
  EXPECT_EQ(reason_of([&] { File::open_to_read(folder.path()); }), std::errc::is_a_directory);
  EXPECT_EQ(reason_of([&] { File::open_to_read(folder.path("missing")); }),
            std::errc::no_such_file_or_directory);
}

TEST(PlatformFile, AppendsEachWriteAndReadsToTheEnd) {
  const TemporaryFolder folder;
  const std::string path = folder.path("file");
  {
    File file = File::create_new(path);
    file.write(eight_bytes(1));
    file.write({});
    file.write(eight_bytes(9));
    file.flush_to_disk();
  }
  File file = File::open_to_read(path);
  EXPECT_EQ(file.size(), 16U);
  std::vector<std::byte> bytes(100);
  std::size_t used = 0;
  while (const std::size_t got = file.read(std::span(bytes).subspan(used))) used += got;
  ASSERT_EQ(used, 16U);
  for (std::size_t i = 0; i < used; ++i) EXPECT_EQ(bytes[i], static_cast<std::byte>(i + 1));
}

TEST(PlatformFile, ReadsAndWritesAtPositionsBeyondFourGibibytes) {
  const TemporaryFolder folder;
  File file = File::create_temporary(folder.path());
  constexpr std::uint64_t kFar = (std::uint64_t{4} << 30U) + 3;
  file.write_at(kFar, eight_bytes(100));
  file.write_at(3, eight_bytes(10));  // the offset that a 32-bit position would wrap to
  EXPECT_EQ(file.size(), kFar + 8);
  std::array<std::byte, 8> bytes{};
  file.read_at(kFar, bytes);
  EXPECT_EQ(bytes, eight_bytes(100));
  file.read_at(3, bytes);
  EXPECT_EQ(bytes, eight_bytes(10));
}

TEST(PlatformFile, FailsToReadPastItsEnd) {
  const TemporaryFolder folder;
  File file = File::create_temporary(folder.path());
  file.write_at(0, eight_bytes(1));
  std::array<std::byte, 8> bytes{};
  EXPECT_EQ(reason_of([&] { file.read_at(1, bytes); }), std::errc::io_error);
  EXPECT_EQ(reason_of([&] { file.read_at(8, bytes); }), std::errc::io_error);
  EXPECT_EQ(reason_of([&] { file.read_at(0, bytes); }), std::error_code());
}

TEST(PlatformFile, ServesSeveralThreadsAtOnce) {
  const TemporaryFolder folder;
  File file = File::create_temporary(folder.path());
  constexpr int kThreads = 4;
  constexpr std::uint64_t kRounds = 500;
  std::vector<std::thread> threads;
  std::atomic<int> wrong{0};
  for (int t = 0; t < kThreads; ++t) {
    threads.emplace_back([&, t] {
      for (std::uint64_t round = 0; round < kRounds; ++round) {
        const std::uint64_t at = 8 * (kThreads * round + static_cast<std::uint64_t>(t));
        std::array<std::byte, 8> bytes{};
        file.write_at(at, eight_bytes(10 * t));
        file.read_at(at, bytes);
        if (bytes != eight_bytes(10 * t)) ++wrong;
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(wrong, 0);
  EXPECT_EQ(file.size(), 8 * kThreads * kRounds);
}

TEST(PlatformFile, LeavesNoTemporaryFileBehind) {
  const TemporaryFolder folder;
  {
    File file = File::create_temporary(folder.path());
    file.write_at(0, eight_bytes(1));
    const File moved = std::move(file);
    EXPECT_EQ(moved.size(), 8U);
  }
  EXPECT_EQ(folder.count(), 0U);
  EXPECT_TRUE(reason_of([&] { File::create_temporary(folder.path("missing")); }));
}

TEST(PlatformTemporaryFolder, IsAFolderForNewFiles) {
  EXPECT_EQ(file_kind(temporary_folder()), FileKind::folder);
  EXPECT_FALSE(write_refusal(temporary_folder()));
}

TEST(PlatformFileLock, RejectsASecondHolder) {
  const TemporaryFolder folder;
  const std::string path = folder.path("lock");
  const auto take = [&] { const FileLock lock(path); };
  {
    const FileLock lock(path);
    EXPECT_EQ(reason_of(take), std::errc::resource_unavailable_try_again);
    EXPECT_EQ(reason_of(take), std::errc::resource_unavailable_try_again);
    EXPECT_EQ(folder.count(), 1U);  // the failed attempts have not removed it
  }
  EXPECT_EQ(folder.count(), 0U);
  EXPECT_EQ(reason_of(take), std::error_code());
}

TEST(PlatformFileLock, HasOneHolderWhileManyThreadsTakeIt) {
  const TemporaryFolder folder;
  const std::string path = folder.path("lock");
  std::atomic<int> holders{0};
  std::atomic<int> intrusions{0};
  std::atomic<int> taken{0};
  const auto take_often = [&] {
    for (int i = 0; i < 3000; ++i) {
      try {
        const FileLock lock(path);
        if (holders.fetch_add(1) != 0) ++intrusions;
        ++taken;
        std::this_thread::yield();
        --holders;
      } catch (const std::system_error&) {
        // Another thread holds it.
      }
    }
  };
  std::vector<std::thread> threads;
  for (int i = 0; i < 4; ++i) threads.emplace_back(take_often);
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(intrusions, 0);
  EXPECT_GT(taken, 100);
}

TEST(PlatformFileLock, TakesALockWhoseHolderWasKilled) {
  const TemporaryFolder folder;
  spill(folder.path("lock"), "");
  EXPECT_EQ(reason_of([&] { const FileLock lock(folder.path("lock")); }), std::error_code());
  EXPECT_EQ(folder.count(), 0U);
}

TEST(PlatformFileLock, ReportsWhyItCannotBeCreated) {
  const TemporaryFolder folder;
  EXPECT_EQ(reason_of([&] { const FileLock lock(folder.path("missing/lock")); }),
            std::errc::no_such_file_or_directory);
}

TEST(PlatformMemory, GrowsWithTheMemoryThatIsTouched) {
  constexpr std::uint64_t kMebibyte = 1U << 20U;
  const std::uint64_t before = peak_rss_bytes();
  ASSERT_GT(before, kMebibyte / 4);
  ASSERT_LT(before, 1024 * kMebibyte);
  // Allocate more than the peak so far, of which some may have been freed.
  const std::vector<std::byte> touched(before + 64 * kMebibyte, std::byte{1});
  EXPECT_EQ(touched[touched.size() / 2], std::byte{1});
  EXPECT_GE(peak_rss_bytes(), before + 60 * kMebibyte);
}

TEST(PlatformThreadTime, GrowsWithWork) {
  const double start = thread_cpu_seconds();
  const double step = thread_cpu_step_seconds();
  EXPECT_GT(step, 0);
  EXPECT_LT(step, 0.1);
  // Other processes may delay this thread.
  for (int i = 0; i < 200 && thread_cpu_seconds() < start + 3 * step + 0.02; ++i) work_for(0.05);
  EXPECT_GE(thread_cpu_seconds(), start + 3 * step + 0.02);
}

TEST(PlatformThreadTime, ExcludesSleepAndOtherThreads) {
  const double start = thread_cpu_seconds();
  std::this_thread::sleep_for(std::chrono::milliseconds(200));
  double other = 0;
  std::thread worker([&] {
    const double begin = thread_cpu_seconds();
    for (int i = 0; i < 200 && other < 0.2; ++i) {
      work_for(0.05);
      other = thread_cpu_seconds() - begin;
    }
  });
  worker.join();
  EXPECT_GE(other, 0.2);
  EXPECT_LT(thread_cpu_seconds() - start, 0.15);
}

#ifndef _WIN32
TEST(PlatformStopSignalDeathTest, RaisesTheFlagOnceAndEndsTheProcessTheSecondTime) {
  ::testing::GTEST_FLAG(death_test_style) = "threadsafe";
  for (const int signal : {SIGINT, SIGTERM}) {
    const auto signal_twice = [signal] {
      static std::atomic<bool> flag{false};
      set_on_stop_signal(flag);
      if (flag) std::exit(1);
      std::raise(signal);
      if (!flag) std::exit(2);
      std::raise(signal);
      std::exit(3);
    };
    EXPECT_EXIT(signal_twice(), ::testing::KilledBySignal(signal), "");
  }
}

TEST(PlatformTerminalDeathTest, IsNotAFileOrPipe) {
  ::testing::GTEST_FLAG(death_test_style) = "threadsafe";
  // GoogleTest captures what the statement writes to standard error.
  EXPECT_EXIT(std::exit(stderr_is_terminal() ? 1 : 0), ::testing::ExitedWithCode(0), "");
}
#endif

}  // namespace
}  // namespace pellucid::platform
