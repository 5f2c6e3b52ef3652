// The output of `compare -o`: one page, or a folder for the page, its JSON and all images.
#pragma once

#include <string>

#include "pellucid/compare_report.h"

namespace pellucid::cli {

class CompareOutput {
 public:
  // The path is a folder if a folder of that name exists, if it ends in '/', or if it is new and does not end
  // in .html or .htm. If it is empty, nothing is written.
  explicit CompareOutput(const std::string& path);

  // Throws Error{cannot_write} if write() would fail, so that this is known before minutes of work.
  void check() const;
  // Writes every file completely or not at all. The page comes last, because it shows that everything is
  // there.
  void write(const CompareReport& report) const;

 private:
  [[nodiscard]] std::string inside(const std::string& name) const;

  std::string path_;
  bool is_folder_ = false;
};

}  // namespace pellucid::cli
