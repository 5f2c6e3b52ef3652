// A temporary folder for the files of one test, and functions that read and write files without the library.
#pragma once

#include <filesystem>
#include <fstream>
#include <random>
#include <stdexcept>
#include <string>

#include "base/platform/platform.h"

namespace pellucid::testing {

// A folder that the destructor removes with everything in it. Its path is UTF-8.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::random_device random;
    const std::filesystem::path parent = std::filesystem::temp_directory_path();
    do {
      folder_ = parent / ("pellucid-test-" + std::to_string(random()));
    } while (!std::filesystem::create_directory(folder_));
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  [[nodiscard]] std::string path() const { return platform::to_utf8(folder_); }
  [[nodiscard]] std::string path(const std::string& name) const {
    return platform::to_utf8(folder_ / platform::to_path(name));
  }
  // Returns the number of files and folders in it.
  [[nodiscard]] std::size_t count() const {
    const std::filesystem::directory_iterator entries(folder_);
    return static_cast<std::size_t>(std::distance(begin(entries), end(entries)));
  }

 private:
  std::filesystem::path folder_;
};

// Returns the content of a file without using the library.
inline std::string slurp(const std::string& path) {
  std::ifstream file(platform::to_path(path), std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

// Writes a file without using the library.
inline void spill(const std::string& path, const std::string& text) {
  std::ofstream(platform::to_path(path), std::ios::binary) << text;
}

}  // namespace pellucid::testing
