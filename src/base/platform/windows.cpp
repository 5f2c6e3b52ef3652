// Implements platform.h on Win32.
#define WIN32_LEAN_AND_MEAN
#define NOMINMAX
// clang-format off
#include <windows.h>
#include <psapi.h>  // needs windows.h
// clang-format on

#include <algorithm>

#include "base/platform/platform.h"

namespace pellucid::platform {
namespace {

constexpr DWORD kShareAll = FILE_SHARE_READ | FILE_SHARE_WRITE | FILE_SHARE_DELETE;
constexpr std::size_t kMostAtOnce = std::size_t{1} << 30U;

// Converts an error to the POSIX error that stands for it, if there is one. The messages of Windows are
// translated and are not in UTF-8.
std::error_code to_code(DWORD error) {
  const std::error_code code(static_cast<int>(error), std::system_category());
  const std::error_condition known = code.default_error_condition();
  return known.category() == std::generic_category() ? std::error_code(known.value(), std::generic_category())
                                                     : code;
}

[[noreturn]] void fail(DWORD error) {
  throw std::system_error(to_code(error));
}

[[noreturn]] void fail(std::errc reason) {
  throw std::system_error(std::make_error_code(reason));
}

HANDLE to_handle(std::intptr_t handle) {
  return reinterpret_cast<HANDLE>(handle);
}

// Closes a handle when it goes out of scope.
class ScopedHandle {
 public:
  explicit ScopedHandle(HANDLE handle) : handle_(handle) {}
  ScopedHandle(const ScopedHandle&) = delete;
  ScopedHandle& operator=(const ScopedHandle&) = delete;
  ~ScopedHandle() {
    if (is_open()) ::CloseHandle(handle_);
  }
  [[nodiscard]] bool is_open() const { return handle_ != INVALID_HANDLE_VALUE; }
  [[nodiscard]] HANDLE get() const { return handle_; }

 private:
  HANDLE handle_;
};

HANDLE open(const std::wstring& name, DWORD access, DWORD share, DWORD creation, DWORD flags) {
  return ::CreateFileW(name.c_str(), access, share, nullptr, creation, flags, nullptr);
}

std::intptr_t open_or_fail(const std::wstring& name, DWORD access, DWORD share, DWORD creation, DWORD flags) {
  HANDLE handle = open(name, access, share, creation, flags);
  if (handle == INVALID_HANDLE_VALUE) fail(::GetLastError());
  return reinterpret_cast<std::intptr_t>(handle);
}

DWORD size_of_step(std::size_t bytes) {
  return static_cast<DWORD>(std::min(bytes, kMostAtOnce));
}

OVERLAPPED position(std::uint64_t offset) {
  OVERLAPPED at{};
  at.Offset = static_cast<DWORD>(offset);
  at.OffsetHigh = static_cast<DWORD>(offset >> 32U);
  return at;
}

double seconds(const FILETIME& time) {
  ULARGE_INTEGER steps;
  steps.LowPart = time.dwLowDateTime;
  steps.HighPart = time.dwHighDateTime;
  return 1e-7 * static_cast<double>(steps.QuadPart);
}

std::atomic<std::atomic<bool>*> stop_flag{nullptr};

BOOL WINAPI raise_stop_flag(DWORD event) {
  if (event != CTRL_C_EVENT && event != CTRL_BREAK_EVENT) return FALSE;
  // FALSE passes the event on to the system, which ends the process.
  return stop_flag.load()->exchange(true) ? FALSE : TRUE;
}

}  // namespace

std::string temporary_folder() {
  std::wstring folder(MAX_PATH + 1, L'\0');
  const DWORD length = ::GetTempPathW(static_cast<DWORD>(folder.size()), folder.data());
  if (length == 0) fail(::GetLastError());
  folder.resize(length);
  return to_utf8(folder);
}

FileKind file_kind(const std::string& path) {
  // Requesting no access works even if another process has opened the file exclusively.
  const ScopedHandle file(
      open(to_path(path).wstring(), 0, kShareAll, OPEN_EXISTING, FILE_FLAG_BACKUP_SEMANTICS));
  if (!file.is_open()) return FileKind::missing;
  if (::GetFileType(file.get()) != FILE_TYPE_DISK) return FileKind::device;
  BY_HANDLE_FILE_INFORMATION info;
  if (::GetFileInformationByHandle(file.get(), &info) == 0) return FileKind::missing;
  return (info.dwFileAttributes & FILE_ATTRIBUTE_DIRECTORY) != 0 ? FileKind::folder : FileKind::regular;
}

std::error_code write_refusal(const std::string& path) {
  const FileKind kind = file_kind(path);
  if (kind == FileKind::device) return {};  // opening a device may have side effects
  const bool is_folder = kind == FileKind::folder;
  const ScopedHandle file(open(to_path(path).wstring(), is_folder ? FILE_ADD_FILE : FILE_WRITE_DATA,
                               kShareAll, OPEN_EXISTING, is_folder ? FILE_FLAG_BACKUP_SEMANTICS : 0));
  return file.is_open() ? std::error_code() : to_code(::GetLastError());
}

void remove_empty_folder(const std::string& path) {
  ::RemoveDirectoryW(to_path(path).wstring().c_str());
}

File File::open_to_read(const std::string& path) {
  const std::wstring name = to_path(path).wstring();
  HANDLE handle = open(name, GENERIC_READ, kShareAll, OPEN_EXISTING, FILE_ATTRIBUTE_NORMAL);
  if (handle == INVALID_HANDLE_VALUE) {
    const DWORD error = ::GetLastError();
    if (file_kind(path) == FileKind::folder) fail(std::errc::is_a_directory);
    fail(error);
  }
  return File(reinterpret_cast<std::intptr_t>(handle));
}

File File::open_to_write(const std::string& path) {
  return File(
      open_or_fail(to_path(path).wstring(), GENERIC_WRITE, kShareAll, OPEN_EXISTING, FILE_ATTRIBUTE_NORMAL));
}

File File::create_new(const std::string& path) {
  return File(open_or_fail(to_path(path).wstring(), GENERIC_WRITE, 0, CREATE_NEW, FILE_ATTRIBUTE_NORMAL));
}

File File::create_temporary(const std::string& folder) {
  std::wstring name(MAX_PATH, L'\0');
  // This call creates an empty file with a new name. The file is then opened again.
  if (::GetTempFileNameW(to_path(folder).wstring().c_str(), L"pel", 0, name.data()) == 0) {
    fail(::GetLastError());
  }
  return File(open_or_fail(name, GENERIC_READ | GENERIC_WRITE, 0, CREATE_ALWAYS,
                           FILE_ATTRIBUTE_TEMPORARY | FILE_FLAG_DELETE_ON_CLOSE));
}

File::~File() {
  if (handle_ != kClosed) ::CloseHandle(to_handle(handle_));
}

std::uint64_t File::size() const {
  if (::GetFileType(to_handle(handle_)) != FILE_TYPE_DISK) return 0;
  LARGE_INTEGER size;
  if (::GetFileSizeEx(to_handle(handle_), &size) == 0) fail(::GetLastError());
  return static_cast<std::uint64_t>(size.QuadPart);
}

std::size_t File::read(std::span<std::byte> bytes) {
  DWORD got = 0;
  if (::ReadFile(to_handle(handle_), bytes.data(), size_of_step(bytes.size()), &got, nullptr) == 0) {
    if (::GetLastError() == ERROR_BROKEN_PIPE) return 0;  // the other end has been closed
    fail(::GetLastError());
  }
  return got;
}

void File::write(std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    DWORD written = 0;
    if (::WriteFile(to_handle(handle_), bytes.data(), size_of_step(bytes.size()), &written, nullptr) == 0) {
      fail(::GetLastError());
    }
    bytes = bytes.subspan(written);
  }
}

void File::read_at(std::uint64_t offset, std::span<std::byte> bytes) const {
  while (!bytes.empty()) {
    OVERLAPPED at = position(offset);
    DWORD got = 0;
    if (::ReadFile(to_handle(handle_), bytes.data(), size_of_step(bytes.size()), &got, &at) == 0 &&
        ::GetLastError() != ERROR_HANDLE_EOF) {
      fail(::GetLastError());
    }
    if (got == 0) fail(std::errc::io_error);
    bytes = bytes.subspan(got);
    offset += got;
  }
}

void File::write_at(std::uint64_t offset, std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    OVERLAPPED at = position(offset);
    DWORD written = 0;
    if (::WriteFile(to_handle(handle_), bytes.data(), size_of_step(bytes.size()), &written, &at) == 0) {
      fail(::GetLastError());
    }
    if (written == 0) fail(std::errc::no_space_on_device);
    bytes = bytes.subspan(written);
    offset += written;
  }
}

void File::flush_to_disk() {
  if (::FlushFileBuffers(to_handle(handle_)) == 0) fail(::GetLastError());
}

// A file that is opened without sharing acts as a lock. The system removes it with its last handle.
FileLock::FileLock(std::string path)
    : path_(std::move(path)),
      handle_(reinterpret_cast<std::intptr_t>(open(to_path(path_).wstring(),
                                                   GENERIC_READ | GENERIC_WRITE | DELETE, 0, OPEN_ALWAYS,
                                                   FILE_FLAG_DELETE_ON_CLOSE))) {
  if (to_handle(handle_) != INVALID_HANDLE_VALUE) return;
  const DWORD error = ::GetLastError();
  if (error == ERROR_SHARING_VIOLATION) fail(std::errc::resource_unavailable_try_again);
  fail(error);
}

FileLock::~FileLock() {
  ::CloseHandle(to_handle(handle_));
}

std::uint64_t peak_rss_bytes() {
  PROCESS_MEMORY_COUNTERS counters{};
  if (::K32GetProcessMemoryInfo(::GetCurrentProcess(), &counters, sizeof(counters)) == 0) return 0;
  return counters.PeakWorkingSetSize;
}

double thread_cpu_seconds() {
  FILETIME made{};
  FILETIME ended{};
  FILETIME kernel{};
  FILETIME user{};
  ::GetThreadTimes(::GetCurrentThread(), &made, &ended, &kernel, &user);
  return seconds(kernel) + seconds(user);
}

// The times of threads advance with the interrupts of the system clock.
double thread_cpu_step_seconds() {
  DWORD adjustment = 0;
  DWORD interval = 0;
  BOOL is_fixed = FALSE;
  if (::GetSystemTimeAdjustment(&adjustment, &interval, &is_fixed) == 0) return 1.0 / 64;
  return 1e-7 * interval;
}

bool stderr_is_terminal() {
  HANDLE console = ::GetStdHandle(STD_ERROR_HANDLE);
  DWORD mode = 0;
  if (::GetConsoleMode(console, &mode) == 0) return false;
  return ::SetConsoleMode(console, mode | ENABLE_PROCESSED_OUTPUT | ENABLE_VIRTUAL_TERMINAL_PROCESSING) != 0;
}

void set_on_stop_signal(std::atomic<bool>& flag) {
  stop_flag = &flag;
  ::SetConsoleCtrlHandler(raise_stop_flag, TRUE);
}

}  // namespace pellucid::platform
