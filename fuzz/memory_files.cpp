// Implements input_file.h with files in memory, for libFuzzer. It replaces functions of src/base/file.cpp:
// the linker takes the first definition that it meets.
#include <map>
#include <vector>

#include "input_file.h"
#include "pellucid/base.h"

namespace pellucid {
namespace {

std::map<std::string, std::vector<std::byte>>& files() {
  static std::map<std::string, std::vector<std::byte>> all;
  return all;
}

}  // namespace

std::vector<std::byte> read_file(const std::string& path, std::uint64_t max_bytes) {
  const auto found = files().find(path);
  if (found == files().end() || found->second.size() > max_bytes)
    throw Error(ErrorKind::bad_input, path + ": it is missing or too large");
  return found->second;
}

void write_file_atomically(const std::string& path, std::span<const std::byte> bytes) {
  files()[path].assign(bytes.begin(), bytes.end());
}

void write_file_atomically(const std::string& path, std::string_view text) {
  write_file_atomically(path, std::as_bytes(std::span(text)));
}

namespace fuzz {

std::string path_for(std::string_view ending) {
  return "/memory/input" + std::string(ending);
}

void write_input(const std::string& path, std::span<const std::uint8_t> bytes) {
  write_file_atomically(path, std::as_bytes(bytes));
}

}  // namespace fuzz
}  // namespace pellucid
