// A temporary file for what does not fit into the memory that a run may take.
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

// Words in a file in platform::temporary_folder(): it is gone with the program, however that ends.
// Throws Error{cannot_write} naming the folder and the reason. Calls from several threads are safe.
class SpillFile {
 public:
  SpillFile();
  ~SpillFile();
  SpillFile(const SpillFile&) = delete;
  SpillFile& operator=(const SpillFile&) = delete;

  std::uint64_t append(std::span<const std::uint32_t> words);  // returns where they begin, in words
  void read(std::uint64_t position, std::span<std::uint32_t> words) const;

 private:
  std::string folder_;
  std::unique_ptr<platform::File> file_;
  std::mutex mutex_;
  std::uint64_t end_ = 0;  // words
};

}  // namespace pellucid
