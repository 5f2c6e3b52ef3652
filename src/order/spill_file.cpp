// A nameless temporary file: see spill_file.h.
#include "spill_file.h"

#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <system_error>
#include <vector>

#include "pellucid/base.h"

namespace pellucid {
namespace {

[[noreturn]] void fail(const std::string& folder, const char* what, int error) {
  throw Error(ErrorKind::cannot_write,
              folder + ": cannot " + what + " a temporary file: " + std::generic_category().message(error));
}

std::string temporary_folder() {
  const char* folder = std::getenv("TMPDIR");
  return folder != nullptr && *folder != '\0' ? folder : "/tmp";
}

}  // namespace

SpillFile::SpillFile() : folder_(temporary_folder()) {
  std::string name = folder_ + "/pellucid-XXXXXX";
  file_ = ::mkstemp(name.data());
  if (file_ < 0) fail(folder_, "make", errno);
  ::unlink(name.c_str());
}

SpillFile::~SpillFile() {
  ::close(file_);
}

std::uint64_t SpillFile::append(std::span<const std::uint32_t> words) {
  const std::lock_guard lock(mutex_);
  const std::uint64_t begin = end_;
  const std::span<const std::byte> bytes = std::as_bytes(words);
  for (std::size_t done = 0; done < bytes.size();) {
    const ssize_t written = ::pwrite(file_, bytes.data() + done, bytes.size() - done,
                                     static_cast<off_t>(begin * sizeof(std::uint32_t) + done));
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) fail(folder_, "write to", written == 0 ? ENOSPC : errno);
    done += static_cast<std::size_t>(written);
  }
  end_ += words.size();
  return begin;
}

void SpillFile::read(std::uint64_t position, std::span<std::uint32_t> words) const {
  const std::span<std::byte> bytes = std::as_writable_bytes(words);
  for (std::size_t done = 0; done < bytes.size();) {
    const ssize_t got = ::pread(file_, bytes.data() + done, bytes.size() - done,
                                static_cast<off_t>(position * sizeof(std::uint32_t) + done));
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) fail(folder_, "read from", got == 0 ? EIO : errno);
    done += static_cast<std::size_t>(got);
  }
}

}  // namespace pellucid
