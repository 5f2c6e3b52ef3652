// Implements input_file.h with files on the disk, for corpus_test.
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>

#include "input_file.h"

namespace pellucid::fuzz {
namespace {

// A folder that is removed when the program ends.
struct Folder {
  std::filesystem::path path =
      std::filesystem::temp_directory_path() / ("pellucid-fuzz-" + std::to_string(::getpid()));
  Folder() { std::filesystem::create_directories(path); }
  ~Folder() {
    std::error_code ignored;
    std::filesystem::remove_all(path, ignored);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
};

}  // namespace

std::string path_for(std::string_view ending) {
  static const Folder kFolder;
  return (kFolder.path / "input").string() + std::string(ending);
}

void write_input(const std::string& path, std::span<const std::uint8_t> bytes) {
  std::FILE* file = std::fopen(path.c_str(), "wb");
  if (file == nullptr || std::fwrite(bytes.data(), 1, bytes.size(), file) != bytes.size()) std::abort();
  std::fclose(file);
}

}  // namespace pellucid::fuzz
