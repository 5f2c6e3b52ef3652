// What `compare -o` names: one page, or a folder for the page, its JSON and all pictures.
#pragma once

#include <string>

#include "pellucid/compare_report.h"

namespace pellucid::cli {

class CompareOutput {
 public:
  // A folder, if there is one of that name, it ends in '/', or it is new and has not .html or .htm at its
  // end. Empty: nothing is written.
  explicit CompareOutput(const std::string& path);

  // Throws Error{cannot_write} if write() could not: known now, not after minutes of work.
  void check() const;
  // Every file as a whole or not at all; the page, which says that all is there, is the last one.
  void write(const CompareReport& report) const;

 private:
  [[nodiscard]] std::string inside(const std::string& name) const;

  std::string path_;
  bool is_folder_ = false;
};

}  // namespace pellucid::cli
