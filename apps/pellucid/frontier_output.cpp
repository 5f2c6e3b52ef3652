// Where `pellucid order` writes: see frontier_output.h.
#include "frontier_output.h"

#include <filesystem>

namespace pellucid::cli {
namespace {

bool is_svg(const std::string& path) {
  return std::filesystem::path(path).extension() == ".svg";
}

}  // namespace

void check_writable(const std::string& path) {
  const std::filesystem::path folder = std::filesystem::path(path).parent_path();
  std::error_code ignored;
  if (!folder.empty() && !std::filesystem::is_directory(folder, ignored)) {
    throw Error(ErrorKind::cannot_write, path + ": cannot write: there is no folder " + folder.string());
  }
  if (std::filesystem::is_directory(path, ignored)) {
    throw Error(ErrorKind::cannot_write, path + ": cannot write: it is a directory");
  }
}

void check_frontier_path(const std::string& path) {
  if (!is_svg(path) && std::filesystem::path(path).extension() != ".json") {
    throw Error(ErrorKind::bad_argument, path + ": a frontier is written as .json or .svg");
  }
  check_writable(path);
}

void write_frontier(const FrontierReport& report, const std::vector<std::string>& paths) {
  for (const std::string& path : paths) {
    write_file_atomically(path, is_svg(path) ? frontier_svg(report) : to_json(report));
  }
}

}  // namespace pellucid::cli
