// Scripts and styles of pages, embedded by CMake: compare_page.css, compare_viewer.js, compare_tables.js.
#pragma once

namespace pellucid {

extern const char* const kCompareStyle;
extern const char* const kCompareViewer;
extern const char* const kCompareTables;

}  // namespace pellucid
