// Where the pictures of a report of techniques lie beside it.
#pragma once

#include <string>

#include "pellucid/compare_report.h"

namespace pellucid {

// "images/stack-f2b-difference.png"; `what`: "f2b-difference". The scene's number where there are several.
std::string image_path(const CompareReport& report, std::size_t scene, const std::string& what);

}  // namespace pellucid
