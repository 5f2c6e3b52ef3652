// Tests read_file() and write_file_atomically(): files appear complete or not at all, and errors name the
// path.
#include <gtest/gtest.h>

#include <atomic>
#include <filesystem>
#include <functional>
#include <system_error>
#include <thread>

#include "pellucid/base.h"
#include "temporary_folder.h"

#ifndef _WIN32
#include <sys/resource.h>

#include <csignal>
#endif

namespace pellucid {
namespace {

namespace fs = std::filesystem;
using platform::to_path;
using testing::slurp;
using testing::spill;
using testing::TemporaryFolder;

std::string text_of(const std::vector<std::byte>& bytes) {
  std::string text;
  for (const std::byte byte : bytes) text += static_cast<char>(byte);
  return text;
}

std::string some_text(std::size_t size) {
  Random random(size);
  std::string text(size, ' ');
  for (char& c : text) c = static_cast<char>(random.below(256));
  return text;
}

// Expects an error of this kind whose message is one line, begins with the path and contains the reason.
void expect_error(ErrorKind kind, const std::string& path, const std::string& reason,
                  const std::function<void()>& work) {
  try {
    work();
    ADD_FAILURE() << path << ": there was no error";
  } catch (const Error& error) {
    const std::string message = error.what();
    EXPECT_EQ(error.kind(), kind) << message;
    EXPECT_TRUE(message.starts_with(path + ": ")) << message;
    EXPECT_TRUE(message.find(reason) != std::string::npos) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  }
}

// Makes writes to `path` fail after the temporary file has been created in its folder.
class FailingWrites {
 public:
#ifdef _WIN32
  // Windows cannot replace a file that is open elsewhere.
  explicit FailingWrites(const std::string& path) : open_(to_path(path), std::ios::binary) {}

 private:
  std::ifstream open_;
#else
  explicit FailingWrites(const std::string& /*path*/) : handler_(std::signal(SIGXFSZ, SIG_IGN)) {
    ::getrlimit(RLIMIT_FSIZE, &limit_);
    rlimit low = limit_;
    low.rlim_cur = 10;
    ::setrlimit(RLIMIT_FSIZE, &low);
  }
  ~FailingWrites() {
    ::setrlimit(RLIMIT_FSIZE, &limit_);
    std::signal(SIGXFSZ, handler_);
  }
  FailingWrites(const FailingWrites&) = delete;
  FailingWrites& operator=(const FailingWrites&) = delete;

 private:
  void (*handler_)(int);
  rlimit limit_{};
#endif
};

TEST(ReadFile, ReturnsEveryByteOfFilesOfAnySize) {
  const TemporaryFolder folder;
  constexpr std::size_t kChunk = 1U << 20U;  // read_file() reads in chunks of this size
  for (const std::size_t size :
       {std::size_t{0}, std::size_t{1}, kChunk - 1, kChunk, kChunk + 1, 3 * kChunk}) {
    const std::string text = some_text(size);
    spill(folder.path("file"), text);
    EXPECT_TRUE(text_of(read_file(folder.path("file"))) == text) << size;
  }
}

TEST(ReadFile, RejectsFilesLargerThanTheLimit) {
  const TemporaryFolder folder;
  const std::string path = folder.path("file");
  spill(path, "123456789");
  EXPECT_EQ(text_of(read_file(path, 9)), "123456789");
  expect_error(ErrorKind::bad_input, path, "larger than the limit", [&] { read_file(path, 8); });
#ifdef __linux__
  // The size of this file is reported as 0.
  expect_error(ErrorKind::bad_input, "/proc/self/status", "larger than the limit",
               [] { read_file("/proc/self/status", 8); });
#endif
}

TEST(ReadFile, ReportsAFolderInOneLine) {
  const TemporaryFolder folder;
  expect_error(ErrorKind::bad_input, folder.path(), "cannot read: it is a directory",
               [&] { read_file(folder.path()); });
}

TEST(ReadFile, ReportsAMissingFileAndTheReason) {
  const TemporaryFolder folder;
  const std::string reason = std::make_error_code(std::errc::no_such_file_or_directory).message();
  for (const char* name : {"missing", "missing/file"}) {
    const std::string path = folder.path(name);
    expect_error(ErrorKind::bad_input, path, "cannot read: " + reason, [&] { read_file(path); });
  }
}

TEST(WriteFile, ReplacesWhatWasThereAndLeavesNothingElse) {
  const TemporaryFolder folder;
  const std::string path = folder.path("file");
  for (const std::size_t size : {100000U, 10U, 0U}) {
    const std::string text = some_text(size);
    write_file_atomically(path, text);
    EXPECT_TRUE(slurp(path) == text) << size;
    EXPECT_EQ(folder.count(), 1U);
  }
}

TEST(WriteFile, NeverExposesAPartialFile) {
  const TemporaryFolder folder;
  const std::string path = folder.path("file");
  const std::string first(3000000, 'a');
  const std::string second(2000000, 'b');
  write_file_atomically(path, first);
  std::atomic<int> writes{0};
  std::atomic<int> failures{0};
  std::atomic<bool> done{false};
  bool has_seen_second = false;
  std::thread writer([&] {
    for (; !done; ++writes) {
      // Windows does not replace a file that the reader has open.
      try {
        write_file_atomically(path, writes % 2 == 0 ? second : first);
      } catch (const Error&) {
        ++failures;
      }
    }
  });
  for (int reads = 0; reads < 10 || writes < 10 || !has_seen_second; ++reads) {
    const std::string text = slurp(path);
#ifdef _WIN32
    if (text.empty()) continue;  // it could not be opened at this moment
#endif
    EXPECT_TRUE(text == first || text == second) << text.size();
    has_seen_second = has_seen_second || text == second;
  }
  done = true;
  writer.join();
#ifndef _WIN32
  EXPECT_EQ(failures, 0);
#endif
}

TEST(WriteFile, KeepsTheOldFileAndNoOtherOnFailure) {
  const TemporaryFolder folder;
  const std::string path = folder.path("file");
  spill(path, "old");
  {
    const FailingWrites failing(path);
    expect_error(ErrorKind::cannot_write, path,
                 "cannot write: ", [&] { write_file_atomically(path, std::string(100, 'n')); });
  }
  EXPECT_EQ(slurp(path), "old");
  EXPECT_EQ(folder.count(), 1U);
}

TEST(WriteFile, RefusesToReplaceAFileThatIsReadOnly) {
  const TemporaryFolder folder;
  const std::string path = folder.path("file");
  spill(path, "old");
  const fs::perms all_write = fs::perms::owner_write | fs::perms::group_write | fs::perms::others_write;
  fs::permissions(to_path(path), all_write, fs::perm_options::remove);
  const bool is_privileged = std::ofstream(to_path(path), std::ios::app).is_open();
  if (!is_privileged) {
    expect_error(ErrorKind::cannot_write, path, std::make_error_code(std::errc::permission_denied).message(),
                 [&] { write_file_atomically(path, "new"); });
    EXPECT_EQ(slurp(path), "old");
    EXPECT_EQ(folder.count(), 1U);
  }
  fs::permissions(to_path(path), all_write, fs::perm_options::add);
  if (is_privileged) GTEST_SKIP() << "this user may write to every file";
}

TEST(WriteFile, RefusesAFolderAndAMissingParent) {
  const TemporaryFolder folder;
  expect_error(ErrorKind::cannot_write, folder.path(),
               std::make_error_code(std::errc::is_a_directory).message(),
               [&] { write_file_atomically(folder.path(), "text"); });
  const std::string path = folder.path("missing/file");
  expect_error(ErrorKind::cannot_write, path,
               std::make_error_code(std::errc::no_such_file_or_directory).message(),
               [&] { write_file_atomically(path, "text"); });
  EXPECT_EQ(folder.count(), 0U);
}

TEST(WriteFile, AcceptsFileNamesInAnyLanguage) {
  const TemporaryFolder folder;
  for (const char8_t* name : {u8"Würfel", u8"立方体", u8"куб", u8"🧊 ice"}) {
    const std::u8string utf8 = name;
    const std::string path = folder.path(std::string(utf8.begin(), utf8.end()));
    write_file_atomically(path, "text");
    bool is_listed = false;
    for (const fs::directory_entry& entry : fs::directory_iterator(to_path(folder.path()))) {
      is_listed = is_listed || entry.path().filename().u8string() == utf8;
    }
    EXPECT_TRUE(is_listed) << path;
    EXPECT_EQ(text_of(read_file(path)), "text");
  }
}

#ifndef _WIN32
TEST(WriteFile, LeavesTheModeToTheUmaskOfTheUser) {
  const TemporaryFolder folder;
  spill(folder.path("plain"), "text");
  write_file_atomically(folder.path("file"), "text");
  EXPECT_EQ(fs::status(folder.path("file")).permissions(), fs::status(folder.path("plain")).permissions());
}

TEST(WriteFile, WritesIntoAPipeOrDeviceInPlace) {
  write_file_atomically("/dev/null", "text");
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
  if (!fs::exists("/dev/full")) GTEST_SKIP() << "there is no /dev/full";
  expect_error(ErrorKind::cannot_write, "/dev/full",
               std::make_error_code(std::errc::no_space_on_device).message(),
               [] { write_file_atomically("/dev/full", "text"); });
  EXPECT_TRUE(fs::is_character_file("/dev/full"));
}
#else
TEST(WriteFile, WritesIntoADeviceInPlace) {
  const fs::path before = fs::current_path();
  const TemporaryFolder folder;
  fs::current_path(to_path(folder.path()));
  EXPECT_NO_THROW(write_file_atomically("NUL", "text"));
  fs::current_path(before);
  EXPECT_EQ(folder.count(), 0U);
}
#endif

}  // namespace
}  // namespace pellucid
