// What `pellucid order` came to: was the quality asked for reached, and where are the files of --frontier?
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "pellucid/report.h"

namespace pellucid::cli {

// As check_writable() does, and Error{bad_argument} for an extension that is none of .json and .svg.
void check_frontier_path(const std::string& path);
void write_frontier(const FrontierReport& report, const std::vector<std::string>& paths);

// The error of one primitive and the buffers that it took: what the method measured itself, else the
// validation. < 0: neither.
struct Reached {
  std::string name;
  double ipr = -1, psnr = -1;
  std::size_t buffers = 0;
};
Reached reached_by(const PrimitiveOrderReport& report);
Reached reached_by(const PrimitiveFrontier& primitive);

// Throws Error{quality_missed} for the first primitive that missed the target. `written`: the file that was
// written all the same.
void check_quality(const std::vector<Reached>& all, const OrderOptions& target, const std::string& input,
                   const std::string& written);

}  // namespace pellucid::cli
