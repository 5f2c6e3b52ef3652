// The interface to the operating system: files, locks, memory, time and the terminal. posix.cpp and
// windows.cpp implement it. No other file of the library or the command line includes a system header.
//
// Strings are UTF-8. Functions throw std::system_error with the reason of the system, unless stated
// otherwise.
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

// Converts a UTF-8 string to a path for std::filesystem.
inline std::filesystem::path to_path(const std::string& utf8) {
  return std::u8string(utf8.begin(), utf8.end());
}

// Converts a path to a UTF-8 string.
inline std::string to_utf8(const std::filesystem::path& path) {
  const std::u8string text = path.u8string();
  return {text.begin(), text.end()};
}

// Returns the folder for temporary files: $TMPDIR or else /tmp on POSIX, the result of GetTempPath() on
// Windows.
std::string temporary_folder();

enum class FileKind { missing, regular, folder, device };

// Returns what a path leads to. `device` stands for everything that is written in place, including pipes.
// Returns `missing` if the system cannot tell. Never throws.
FileKind file_kind(const std::string& path);

// Returns the reason why the user may not write to a file or device or create files in a folder. Returns no
// error if the user may.
std::error_code write_refusal(const std::string& path);

// Removes a folder if it is empty. Never throws.
void remove_empty_folder(const std::string& path);

// ------------------------------------------------------------------------------------------------- files

// An open file. The destructor closes it.
class File {
 public:
  // Opens an existing file for reading. Fails with is_a_directory for a folder.
  static File open_to_read(const std::string& path);
  // Opens an existing file for writing from its beginning.
  static File open_to_write(const std::string& path);
  // Creates a file for writing. Fails with file_exists if the file exists.
  static File create_new(const std::string& path);
  // Creates a file for reading and writing, which the system removes when it is closed or when the process
  // ends in any way.
  static File create_temporary(const std::string& folder);

  File(File&& other) noexcept : handle_(std::exchange(other.handle_, kClosed)) {}
  File& operator=(File&&) = delete;
  ~File();

  // Returns the size in bytes, or 0 for pipes and devices.
  [[nodiscard]] std::uint64_t size() const;
  // Reads at most bytes.size() of the next bytes and returns how many were read. Returns 0 only at the end.
  [[nodiscard]] std::size_t read(std::span<std::byte> bytes);
  // Writes all bytes after those of the last call.
  void write(std::span<const std::byte> bytes);
  // Read and write at `offset`, which may be beyond 4 GiB. Several threads may call them at once. Reading
  // fails with io_error if the file ends before all bytes are read.
  void read_at(std::uint64_t offset, std::span<std::byte> bytes) const;
  void write_at(std::uint64_t offset, std::span<const std::byte> bytes);
  // Waits until all written bytes are on the disk.
  void flush_to_disk();

 private:
  static constexpr std::intptr_t kClosed = -1;
  explicit File(std::intptr_t handle) : handle_(handle) {}

  std::intptr_t handle_;  // a file descriptor, or a HANDLE of Windows
};

// A lock that only one object in all processes can hold. It is a file, which the constructor creates if
// necessary and the destructor removes. The system releases the lock of a process that ends without doing so.
class FileLock {
 public:
  // Takes the lock. Fails with resource_unavailable_try_again if it is held. On a POSIX file system without
  // locks it always succeeds.
  explicit FileLock(std::string path);
  ~FileLock();
  FileLock(const FileLock&) = delete;
  FileLock& operator=(const FileLock&) = delete;

 private:
  std::string path_;
  std::intptr_t handle_;
};

// ----------------------------------------------------------------------------------------------- process

// Returns the largest resident set of this process so far, or 0 if the system does not report it. Never
// throws.
std::uint64_t peak_rss_bytes();

// Return the processor time of the calling thread, and the resolution of this time: about a nanosecond on
// Linux and macOS, 1/64 s on Windows. Never throw.
double thread_cpu_seconds();
double thread_cpu_step_seconds();

// Returns whether standard error is a terminal that understands control sequences. On Windows, enables them
// if it is a console. Never throws.
bool stderr_is_terminal();

// Arranges that the first Ctrl-C (on POSIX also the first SIGTERM) sets `flag`. A second one ends the
// process, as if this function had not been called. `flag` must exist as long as the process.
void set_on_stop_signal(std::atomic<bool>& flag);

}  // namespace pellucid::platform
