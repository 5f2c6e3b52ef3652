// Makes a comparison by hand, without rendering, for the tests of the module `report`.
#pragma once

#include <string>

#include "pellucid/compare_report.h"

namespace pellucid::testing {

inline CaptureStats stats_of(std::uint64_t captured, double milliseconds) {
  CaptureStats stats;
  stats.fragments = 1000;
  stats.captured = captured;
  stats.coplanar_pixels = 50;
  stats.covered_pixels = 200;
  stats.deepest_pixel = 3;
  stats.geometry_passes = 2;
  stats.bytes = 12'300;
  stats.milliseconds = milliseconds;
  return stats;
}

inline ComparedTechnique technique(const std::string& name, bool exact, std::uint64_t captured,
                                   double milliseconds) {
  return {name, "how " + name + " works", exact, "", stats_of(captured, milliseconds), ImageError{}, {}};
}

inline CompareReport sample_comparison(const std::string& name = "stack") {
  CompareReport report;
  report.device.name = name + " GPU";
  report.device.driver = "driver";
  report.effect = "transparency";
  report.surfaces = "uniform";
  report.frames = 6;
  ComparedScene& scene = report.scenes.emplace_back();
  scene.input = "dir/" + name + ".glb";
  scene.camera = "30,20,3";
  scene.width = 40;
  scene.height = 20;
  scene.triangles = 12;
  scene.objects = 1;
  scene.reference = "sb";
  scene.exact = stats_of(1000, 5);
  scene.image = {"exact, by sb", {1, 2, 3}};
  scene.pixels_by_depth = {600, 100, 60, 40};
  scene.techniques = {technique("f2b", false, 700, 1), technique("f2b-2p", true, 1000, 8),
                      technique("ll", true, 1000, 4), technique("sb", true, 900, 2)};
  scene.techniques[0].error = ImageError{23.5, 0.25, 31};
  scene.techniques[0].images = {{name, {4, 5}}, {"difference", {6, 7}}};
  ComparedTechnique& failed = scene.techniques.emplace_back();
  failed.name = "kb";
  failed.failure = name + " needs 64-bit atomics";
  ComparedSweep& sweep = report.sweeps.emplace_back();
  sweep.input = name;
  sweep.techniques = {"sb", "kb"};
  for (const std::uint32_t side : {10U, 20U, 40U})
    sweep.points.push_back({side / 40.0, side, side, 0, {stats_of(1000, side), std::nullopt}});
  return report;
}

inline std::size_t occurrences(const std::string& text, const std::string& what) {
  std::size_t count = 0;
  for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos; at += what.size()) ++count;
  return count;
}

}  // namespace pellucid::testing
