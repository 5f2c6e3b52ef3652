// Whole files in and out: see pellucid/base.h.
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <random>

#include "pellucid/base.h"

namespace pellucid {
namespace {

std::string system_reason(int error) {
  return std::strerror(error);
}

// A file descriptor that closes itself, and a path that removes itself unless the file was kept.
struct TemporaryFile {
  int descriptor = -1;
  std::string path;

  TemporaryFile() = default;
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  ~TemporaryFile() {
    if (descriptor >= 0) ::close(descriptor);
    if (!path.empty()) ::unlink(path.c_str());
  }
};

[[noreturn]] void fail_to_write(const std::string& path, int error) {
  throw Error(ErrorKind::cannot_write, path + ": cannot write: " + system_reason(error));
}

// A new file beside `path`, with the mode that open() gives: mkstemp() has another, and to ask for the umask
// is to set it, for all threads. -1: errno.
int open_beside(const std::string& path, std::string& name) {
  constexpr std::string_view kLetters = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ";
  std::random_device random;
  for (int attempt = 0; attempt < 100; ++attempt) {
    name = path + ".";
    for (int i = 0; i < 6; ++i) name += kLetters[random() % kLetters.size()];
    const int descriptor = ::open(name.c_str(), O_CREAT | O_EXCL | O_WRONLY | O_CLOEXEC, 0666);
    if (descriptor >= 0 || errno != EEXIST) return descriptor;
  }
  return -1;
}

bool is_regular_or_missing(const std::string& path) {
  struct stat info {};
  return ::stat(path.c_str(), &info) != 0 || S_ISREG(info.st_mode);
}

void write_all(int descriptor, std::span<const std::byte> bytes, const std::string& path) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail_to_write(path, errno);
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
}

// Devices and pipes (/dev/stdout, /dev/full) have no "whole or not at all": write straight into them.
void write_in_place(const std::string& path, std::span<const std::byte> bytes) {
  TemporaryFile file;
  file.descriptor = ::open(path.c_str(), O_WRONLY | O_CLOEXEC);
  if (file.descriptor < 0) fail_to_write(path, errno);
  write_all(file.descriptor, bytes, path);
}

}  // namespace

std::vector<std::byte> read_file(const std::string& path, std::uint64_t max_bytes) {
  const auto fail = [&](const std::string& reason) -> Error {
    return {ErrorKind::bad_input, path + ": cannot read: " + reason};
  };
  TemporaryFile file;  // never removed: its path stays empty
  file.descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (file.descriptor < 0) throw fail(system_reason(errno));
  struct stat info {};
  if (::fstat(file.descriptor, &info) != 0) throw fail(system_reason(errno));
  if (S_ISDIR(info.st_mode)) throw fail("it is a directory");

  // The size is a hint only: pipes and /proc files say 0.
  std::vector<std::byte> bytes;
  if (static_cast<std::uint64_t>(info.st_size) > max_bytes) throw fail("it is larger than the limit");
  bytes.reserve(static_cast<std::size_t>(info.st_size));
  constexpr std::size_t kChunk = 1U << 20U;
  std::size_t used = 0;
  for (;;) {
    bytes.resize(used + kChunk);
    const ssize_t got = ::read(file.descriptor, bytes.data() + used, kChunk);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) throw fail(system_reason(errno));
    used += static_cast<std::size_t>(got);
    if (got == 0) break;
    if (used > max_bytes) throw fail("it is larger than the limit");
  }
  bytes.resize(used);
  return bytes;
}

void write_file_atomically(const std::string& path, std::span<const std::byte> bytes) {
  if (!is_regular_or_missing(path)) {
    struct stat info {};
    if (::stat(path.c_str(), &info) == 0 && S_ISDIR(info.st_mode)) fail_to_write(path, EISDIR);
    write_in_place(path, bytes);
    return;
  }
  if (::access(path.c_str(), F_OK) == 0 && ::access(path.c_str(), W_OK) != 0) fail_to_write(path, errno);

  TemporaryFile file;
  std::string name;
  file.descriptor = open_beside(path, name);
  if (file.descriptor < 0) fail_to_write(path, errno);
  file.path = name;
  write_all(file.descriptor, bytes, path);
  if (::fsync(file.descriptor) != 0 && errno != EINVAL) fail_to_write(path, errno);
  if (::rename(name.c_str(), path.c_str()) != 0) fail_to_write(path, errno);
  file.path.clear();
}

void write_file_atomically(const std::string& path, std::string_view text) {
  write_file_atomically(path, std::as_bytes(std::span(text.data(), text.size())));
}

}  // namespace pellucid
