// The parts of the page of compare_html(), each in a file of its own.
#pragma once

#include <cstddef>
#include <string>

#include "pellucid/compare_report.h"

namespace pellucid {

// The file's name, without folders.
std::string name_of(const std::string& input);
std::string scene_anchor(std::size_t number);  // "scene-0": the id of its section
std::string sweep_anchor(std::size_t number);

// Links to all sections, and all techniques over all scenes; empty of less than two scenes.
std::string compare_overview(const CompareReport& report);

// Any two pictures over each other, by the page's script; every picture beside its difference, without.
std::string picture_viewer(const ComparedScene& scene, std::size_t number);
// Fragments of every pixel, and what techniques with a budget made of it, with scales.
std::string heat_maps(const ComparedScene& scene);

// Error over time and over memory; time, memory and error of every technique as bars.
std::string technique_plots(const ComparedScene& scene);

// Charts of a parameter.
std::string sweep_section(const ComparedSweep& sweep, std::size_t number);

// <div class="flip"> of radio buttons, which need no script, and the arrow keys go through them; the first
// one is chosen. `kind`: the class of what is shown.
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

}  // namespace pellucid
