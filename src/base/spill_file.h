// A temporary file that holds data for which the memory budget of a run has no space.
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <string>

namespace pellucid {

namespace platform {
class File;
}

// A file of 32-bit words in platform::temporary_folder(). The system removes it when the object is destroyed
// or the process ends in any way. All functions throw Error{cannot_write} that names the folder and the
// reason. append() and read() may be called from several threads at once.
class SpillFile {
 public:
  SpillFile();
  ~SpillFile();
  SpillFile(const SpillFile&) = delete;
  SpillFile& operator=(const SpillFile&) = delete;

  // Appends words and returns the position of the first one, counted in words.
  std::uint64_t append(std::span<const std::uint32_t> words);
  // Reads words.size() words from `position` on, counted in words.
  void read(std::uint64_t position, std::span<std::uint32_t> words) const;

 private:
  std::string folder_;
  std::unique_ptr<platform::File> file_;
  std::mutex mutex_;
  std::uint64_t end_ = 0;  // words
};

}  // namespace pellucid
