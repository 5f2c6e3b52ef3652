// What pellucid asks of the operating system: files, locks, memory, time and the terminal. posix.cpp and
// windows.cpp implement it, and no other file of the library and the command line includes a system header.
//
// Strings are UTF-8. Functions throw std::system_error with the system's reason unless they say otherwise.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <system_error>
#include <utility>

namespace pellucid::platform {

// -------------------------------------------------------------------------------------------- file names

// Returns the path that a string of the library names, for use with std::filesystem.
inline std::filesystem::path to_path(const std::string& utf8) {
  return std::u8string(utf8.begin(), utf8.end());
}

// Returns the string of the library that names a path.
inline std::string to_utf8(const std::filesystem::path& path) {
  const std::u8string text = path.u8string();
  return {text.begin(), text.end()};
}

// Returns the folder for temporary files: $TMPDIR, else /tmp; on Windows what GetTempPath() says.
std::string temporary_folder();

enum class FileKind { missing, regular, folder, device };

// Returns what a path leads to: `device` for everything that is written in place, such as pipes, and
// `missing` also where the system does not say. Never throws.
FileKind file_kind(const std::string& path);

// Returns why this user may not write to a file or device, or make files in a folder; no error where they
// may.
std::error_code write_refusal(const std::string& path);

// Removes a folder if there is nothing in it. Never throws.
void remove_empty_folder(const std::string& path);

// ------------------------------------------------------------------------------------------------- files

// An open file, which is closed with the object.
class File {
 public:
  // Opens what is there for reading. Fails with is_a_directory for a folder.
  static File open_to_read(const std::string& path);
  // Opens what is there for writing from its beginning.
  static File open_to_write(const std::string& path);
  // Makes a file for writing. Fails with file_exists where there is one.
  static File create_new(const std::string& path);
  // Makes a file for reading and writing that is gone when it is closed or when the process ends, however
  // that happens.
  static File create_temporary(const std::string& folder);

  File(File&& other) noexcept : handle_(std::exchange(other.handle_, kClosed)) {}
  File& operator=(File&&) = delete;
  ~File();

  // Returns the size in bytes, 0 for pipes and devices.
  [[nodiscard]] std::uint64_t size() const;
  // Reads some of the bytes that follow, and returns how many: 0 only at the end.
  [[nodiscard]] std::size_t read(std::span<std::byte> bytes);
  // Writes all bytes where the last call has ended.
  void write(std::span<const std::byte> bytes);
  // Reads and writes at `offset`, which may lie beyond 4 GiB. Several threads may do so at once. Reading
  // fails with io_error where the file ends before all bytes are read.
  void read_at(std::uint64_t offset, std::span<std::byte> bytes) const;
  void write_at(std::uint64_t offset, std::span<const std::byte> bytes);
  // Returns once the disk has what was written.
  void flush_to_disk();

 private:
  static constexpr std::intptr_t kClosed = -1;
  explicit File(std::intptr_t handle) : handle_(handle) {}

  std::intptr_t handle_;  // a file descriptor, or a HANDLE of Windows
};

// A lock that one object at a time holds, in all processes. It is a file, which is made where there is none
// and removed with the object. The system frees the lock of a process that ends without doing so.
class FileLock {
 public:
  // Takes the lock. Fails with resource_unavailable_try_again where it is held. Where a file system of POSIX
  // knows no locks, everybody gets it.
  explicit FileLock(std::string path);
  ~FileLock();
  FileLock(const FileLock&) = delete;
  FileLock& operator=(const FileLock&) = delete;

 private:
  std::string path_;
  std::intptr_t handle_;
};

// ----------------------------------------------------------------------------------------------- process

// Returns the largest resident set of this process so far, 0 where the system does not say. Never throws.
std::uint64_t peak_rss_bytes();

// Returns for how long the calling thread has run on a processor, and the step in which this time advances:
// about a nanosecond on Linux and macOS, 1/64 s on Windows. Never throws.
double thread_cpu_seconds();
double thread_cpu_step_seconds();

// Returns whether standard error is a terminal that obeys control sequences. On Windows it is told to, if it
// is a console. Never throws.
bool stderr_is_terminal();

// Sets `flag` when the user presses Ctrl-C (on POSIX also at SIGTERM) for the first time. The second time
// ends the process, as if this function had not been called. `flag` has to live as long as the process.
void set_on_stop_signal(std::atomic<bool>& flag);

}  // namespace pellucid::platform
