// Reads and writes whole files: see pellucid/base.h. It is a file of its own so that the fuzzing harnesses
// can put files in memory in its place (fuzz/memory_files.cpp).
#include <filesystem>
#include <random>
#include <system_error>

#include "base/platform/platform.h"
#include "pellucid/base.h"

namespace pellucid {
namespace {

[[noreturn]] void fail_to_write(const std::string& path, const std::error_code& error) {
  throw Error(ErrorKind::cannot_write, path + ": cannot write: " + error.message());
}

// Removes the file at `path` when it goes out of scope. An empty path stands for no file.
struct TemporaryPath {
  std::filesystem::path path;

  TemporaryPath() = default;
  TemporaryPath(const TemporaryPath&) = delete;
  TemporaryPath& operator=(const TemporaryPath&) = delete;
  ~TemporaryPath() {
    std::error_code ignored;
    if (!path.empty()) std::filesystem::remove(path, ignored);
  }
};

// Creates a file with a new name beside `path` and hands its path to `temporary`.
platform::File create_beside(const std::string& path, TemporaryPath& temporary) {
  constexpr std::string_view kLetters = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ";
  constexpr int kAttempts = 100;
  std::random_device random;
  for (int attempt = 1;; ++attempt) {
    std::string name = path + ".";
    for (int i = 0; i < 6; ++i) name += kLetters[random() % kLetters.size()];
    try {
      platform::File file = platform::File::create_new(name);
      temporary.path = platform::to_path(name);
      return file;
    } catch (const std::system_error& error) {
      if (error.code() != std::errc::file_exists || attempt == kAttempts) throw;
    }
  }
}

void write_beside_and_replace(const std::string& path, std::span<const std::byte> bytes) {
  TemporaryPath temporary;
  {
    platform::File file = create_beside(path, temporary);
    file.write(bytes);
    file.flush_to_disk();
  }  // Windows does not rename an open file.
  std::filesystem::rename(temporary.path, platform::to_path(path));
  temporary.path.clear();
}

}  // namespace

std::vector<std::byte> read_file(const std::string& path, std::uint64_t max_bytes) {
  const auto fail = [&](const std::string& reason) -> Error {
    return {ErrorKind::bad_input, path + ": cannot read: " + reason};
  };
  try {
    platform::File file = platform::File::open_to_read(path);
    // The size is only a hint. Pipes and files in /proc report 0.
    std::vector<std::byte> bytes;
    const std::uint64_t size = file.size();
    if (size > max_bytes) throw fail("it is larger than the limit");
    bytes.reserve(static_cast<std::size_t>(size));
    constexpr std::size_t kChunk = 1U << 20U;
    std::size_t used = 0;
    for (;;) {
      bytes.resize(used + kChunk);
      const std::size_t got = file.read(std::span(bytes).subspan(used));
      used += got;
      if (got == 0) break;
      if (used > max_bytes) throw fail("it is larger than the limit");
    }
    bytes.resize(used);
    return bytes;
  } catch (const std::system_error& error) {
    throw fail(error.code() == std::errc::is_a_directory ? "it is a directory" : error.code().message());
  }
}

void write_file_atomically(const std::string& path, std::span<const std::byte> bytes) {
  try {
    switch (platform::file_kind(path)) {
      case platform::FileKind::folder:
        fail_to_write(path, std::make_error_code(std::errc::is_a_directory));
      case platform::FileKind::device:
        // Devices and pipes (/dev/stdout, /dev/full) cannot be replaced, so they are written in place.
        platform::File::open_to_write(path).write(bytes);
        return;
      case platform::FileKind::regular:
        if (const std::error_code refusal = platform::write_refusal(path)) fail_to_write(path, refusal);
        break;
      case platform::FileKind::missing:
        break;
    }
    write_beside_and_replace(path, bytes);
  } catch (const std::system_error& error) {
    fail_to_write(path, error.code());
  }
}

void write_file_atomically(const std::string& path, std::string_view text) {
  write_file_atomically(path, std::as_bytes(std::span(text.data(), text.size())));
}

}  // namespace pellucid
