// Declares what the files of the page of compare_html() share: its sections, anchors, style and scripts. In:
// a comparison or a part of it. Out: HTML.
#pragma once

#include <cstddef>
#include <string>
#include <utility>

#include "pellucid/compare_report.h"

namespace pellucid {

// Returns the name of a file without its folders.
std::string name_of(const std::string& input);
// Returns the id of a section, such as "scene-0".
std::string scene_anchor(std::size_t number);
std::string sweep_anchor(std::size_t number);

// Returns the images of a scene. The script of the page lays any two of them over each other. Without the
// script, every image is beside its difference from the exact one.
std::string image_viewer(const ComparedScene& scene, std::size_t number);
// Returns the heat maps of a scene and of its techniques, with scales.
std::string heat_map_section(const ComparedScene& scene);
// Returns plots of error over time and over memory, and time, memory and error of every technique as bars.
std::string technique_plots(const ComparedScene& scene);
// Returns the charts of a sweep.
std::string sweep_section(const ComparedSweep& sweep, std::size_t number);

// A group of radio buttons, <div class="flip">. Each button shows one thing, and the first is chosen. It
// needs no script, and the arrow keys move through it. `kind` is the class of what is shown.
class Choices {
 public:
  Choices(std::string id, std::string kind) : id_(std::move(id)), kind_(std::move(kind)) {}
  void add(const std::string& name, const std::string& content);
  [[nodiscard]] std::size_t size() const { return count_; }
  [[nodiscard]] std::string html() const {
    return "<div class=\"flip\" role=\"radiogroup\" aria-label=\"what is shown\">\n" + choices_ + "</div>";
  }

 private:
  std::string id_, kind_, choices_;
  std::size_t count_ = 0;
};

// The contents of compare_page.css, compare_viewer.js and compare_tables.js, which CMake embeds
// (page_files.cpp.in).
extern const char* const kCompareStyle;
extern const char* const kCompareViewer;
extern const char* const kCompareTables;

}  // namespace pellucid
