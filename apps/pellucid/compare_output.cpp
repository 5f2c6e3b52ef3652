// Implements compare_output.h: the page or folder that `compare -o` names.
#include "compare_output.h"

#include <filesystem>

#include "session.h"

namespace pellucid::cli {
namespace {

namespace fs = std::filesystem;

constexpr const char* kReportPage = "report.html";
constexpr const char* kReportJson = "report.json";
constexpr const char* kImages = "images";

bool names_folder(const std::string& path) {
  std::error_code ignored;
  if (path.empty()) return false;
  if (path.back() == '/' || fs::is_directory(path, ignored)) return true;
  const std::string extension = fs::path(path).extension().string();
  return !fs::exists(path, ignored) && extension != ".html" && extension != ".htm";
}

void check_no_file(const std::string& path) {
  std::error_code ignored;
  if (fs::exists(path, ignored) && !fs::is_directory(path, ignored))
    throw Error(ErrorKind::cannot_write, path + ": cannot write: it is not a directory");
}

void make_if_missing(const std::string& path) {
  std::error_code failed;
  fs::create_directory(path, failed);
  if (failed) throw Error(ErrorKind::cannot_write, path + ": cannot make it: " + failed.message());
}

}  // namespace

CompareOutput::CompareOutput(const std::string& path) : path_(path), is_folder_(names_folder(path)) {
  while (is_folder_ && path_.size() > 1 && path_.back() == '/') path_.pop_back();
}

std::string CompareOutput::inside(const std::string& name) const {
  return (fs::path(path_) / name).string();
}

void CompareOutput::check() const {
  if (path_.empty()) return;
  std::error_code ignored;
  if (is_folder_) check_no_file(path_);
  if (!is_folder_ || !fs::exists(path_, ignored)) {
    check_writable(path_);
    return;
  }
  check_writable(inside(kReportPage));
  check_writable(inside(kReportJson));
  const std::string images = inside(kImages);
  check_no_file(images);
  if (fs::exists(images, ignored)) check_writable(images + "/image.png");
}

void CompareOutput::write(const CompareReport& report) const {
  if (path_.empty()) return;
  if (is_folder_) {
    make_if_missing(path_);
    const std::vector<ImageFile> images = image_files(report);
    if (!images.empty()) make_if_missing(inside(kImages));
    for (const ImageFile& image : images)
      write_file_atomically(inside(image.path), std::as_bytes(std::span(*image.png)));
    write_file_atomically(inside(kReportJson), to_json(report, ImageLinks::beside));
  }
  write_file_atomically(is_folder_ ? inside(kReportPage) : path_, compare_html(report));
}

}  // namespace pellucid::cli
