// Where `pellucid order` writes: checks before minutes of work, and the files of --frontier.
#pragma once

#include <string>
#include <vector>

#include "pellucid/frontier_report.h"

namespace pellucid::cli {

// Throws Error{cannot_write} if there is no such folder, or the path is one.
void check_writable(const std::string& path);
// The same, and Error{bad_argument} for an extension that is none of .json and .svg.
void check_frontier_path(const std::string& path);
void write_frontier(const FrontierReport& report, const std::vector<std::string>& paths);

}  // namespace pellucid::cli
