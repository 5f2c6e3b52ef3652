// Implements platform.h on POSIX, for Linux and macOS.
#include <fcntl.h>
#include <sys/file.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <ctime>

#include "base/platform/platform.h"

namespace pellucid::platform {
namespace {

static_assert(sizeof(off_t) >= sizeof(std::uint64_t),
              "compile with _FILE_OFFSET_BITS=64: files may have more than 2 GiB");
// macOS refuses to read or write more than 2 GiB in one call.
constexpr std::size_t kMostAtOnce = std::size_t{1} << 30U;

std::error_code last_error() {
  return {errno, std::system_category()};
}

[[noreturn]] void fail() {
  throw std::system_error(last_error());
}

[[noreturn]] void fail(std::errc reason) {
  throw std::system_error(std::make_error_code(reason));
}

std::size_t size_of_step(std::size_t bytes) {
  return std::min(bytes, kMostAtOnce);
}

int descriptor_of(std::intptr_t handle) {
  return static_cast<int>(handle);
}

struct stat status_of(std::intptr_t handle) {
  struct stat info {};
  if (::fstat(descriptor_of(handle), &info) != 0) fail();
  return info;
}

bool leads_to(const std::string& path, int descriptor) {
  struct stat named {};
  struct stat opened {};
  return ::stat(path.c_str(), &named) == 0 && ::fstat(descriptor, &opened) == 0 &&
         named.st_dev == opened.st_dev && named.st_ino == opened.st_ino;
}

std::atomic<std::atomic<bool>*> stop_flag{nullptr};
static_assert(std::atomic<bool>::is_always_lock_free && std::atomic<std::atomic<bool>*>::is_always_lock_free,
              "a signal handler uses them");

void raise_stop_flag(int /*signal*/) {
  *stop_flag.load() = true;
}

}  // namespace

std::string temporary_folder() {
  const char* folder = std::getenv("TMPDIR");
  return folder != nullptr && *folder != '\0' ? folder : "/tmp";
}

FileKind file_kind(const std::string& path) {
  struct stat info {};
  if (::stat(path.c_str(), &info) != 0) return FileKind::missing;
  if (S_ISREG(info.st_mode)) return FileKind::regular;
  return S_ISDIR(info.st_mode) ? FileKind::folder : FileKind::device;
}

std::error_code write_refusal(const std::string& path) {
  const int wanted = file_kind(path) == FileKind::folder ? W_OK | X_OK : W_OK;
  return ::access(path.c_str(), wanted) == 0 ? std::error_code() : last_error();
}

void remove_empty_folder(const std::string& path) {
  ::rmdir(path.c_str());
}

File File::open_to_read(const std::string& path) {
  File file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  if (file.handle_ == kClosed) fail();
  if (S_ISDIR(status_of(file.handle_).st_mode)) fail(std::errc::is_a_directory);
  return file;
}

File File::open_to_write(const std::string& path) {
  File file(::open(path.c_str(), O_WRONLY | O_CLOEXEC));
  if (file.handle_ == kClosed) fail();
  return file;
}

// open() applies the umask of the user to the mode. mkstemp() would set another mode, and the umask can only
// be read by changing it for all threads.
File File::create_new(const std::string& path) {
  File file(::open(path.c_str(), O_CREAT | O_EXCL | O_WRONLY | O_CLOEXEC, 0666));
  if (file.handle_ == kClosed) fail();
  return file;
}

File File::create_temporary(const std::string& folder) {
  std::string name = folder + "/pellucid-XXXXXX";
  File file(::mkstemp(name.data()));
  if (file.handle_ == kClosed) fail();
  ::unlink(name.c_str());
  return file;
}

File::~File() {
  if (handle_ != kClosed) ::close(descriptor_of(handle_));
}

std::uint64_t File::size() const {
  return static_cast<std::uint64_t>(status_of(handle_).st_size);
}

std::size_t File::read(std::span<std::byte> bytes) {
  for (;;) {
    const ssize_t got = ::read(descriptor_of(handle_), bytes.data(), size_of_step(bytes.size()));
    if (got >= 0) return static_cast<std::size_t>(got);
    if (errno != EINTR) fail();
  }
}

void File::write(std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor_of(handle_), bytes.data(), size_of_step(bytes.size()));
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail();
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
}

void File::read_at(std::uint64_t offset, std::span<std::byte> bytes) const {
  while (!bytes.empty()) {
    const ssize_t got =
        ::pread(descriptor_of(handle_), bytes.data(), size_of_step(bytes.size()), static_cast<off_t>(offset));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) fail();
    if (got == 0) fail(std::errc::io_error);
    bytes = bytes.subspan(static_cast<std::size_t>(got));
    offset += static_cast<std::uint64_t>(got);
  }
}

void File::write_at(std::uint64_t offset, std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::pwrite(descriptor_of(handle_), bytes.data(), size_of_step(bytes.size()),
                                     static_cast<off_t>(offset));
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail();
    if (written == 0) fail(std::errc::no_space_on_device);
    bytes = bytes.subspan(static_cast<std::size_t>(written));
    offset += static_cast<std::uint64_t>(written);
  }
}

void File::flush_to_disk() {
  // EINVAL means that no disk is behind the descriptor.
  if (::fsync(descriptor_of(handle_)) != 0 && errno != EINVAL) fail();
}

FileLock::FileLock(std::string path) : path_(std::move(path)), handle_(-1) {
  constexpr int kMostAttempts = 100;
  for (int attempt = 0; attempt < kMostAttempts; ++attempt) {
    const int descriptor = ::open(path_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
    if (descriptor < 0) fail();
    if (::flock(descriptor, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
      ::close(descriptor);
      break;
    }
    // The last holder may have removed the file between the two calls. Then somebody else can lock a new file
    // of this name, so try again.
    if (leads_to(path_, descriptor)) {
      handle_ = descriptor;
      return;
    }
    ::close(descriptor);
  }
  fail(std::errc::resource_unavailable_try_again);
}

FileLock::~FileLock() {
  ::unlink(path_.c_str());
  ::close(descriptor_of(handle_));
}

std::uint64_t peak_rss_bytes() {
  rusage usage{};
  if (::getrusage(RUSAGE_SELF, &usage) != 0) return 0;
  const auto peak = static_cast<std::uint64_t>(usage.ru_maxrss);
#ifdef __APPLE__
  return peak;
#else
  return peak * 1024U;  // Linux reports kibibytes.
#endif
}

double thread_cpu_seconds() {
  timespec now{};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

double thread_cpu_step_seconds() {
  timespec step{};
  ::clock_getres(CLOCK_THREAD_CPUTIME_ID, &step);
  return static_cast<double>(step.tv_sec) + 1e-9 * static_cast<double>(step.tv_nsec);
}

bool stderr_is_terminal() {
  return ::isatty(STDERR_FILENO) == 1;
}

void set_on_stop_signal(std::atomic<bool>& flag) {
  stop_flag = &flag;
  struct sigaction action {};
  action.sa_handler = raise_stop_flag;
  action.sa_flags = SA_RESTART | static_cast<int>(SA_RESETHAND);
  ::sigaction(SIGINT, &action, nullptr);
  ::sigaction(SIGTERM, &action, nullptr);
}

}  // namespace pellucid::platform
