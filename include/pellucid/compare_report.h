// pellucid/compare_report.h - module `report`: compares capture techniques, as a table, JSON and a page.
//
// In: what every technique captured of a scene, its time and its image, also over a range of a parameter (a
// sweep). Out: text and heat maps. The keys of the JSON are a contract (docs/json.md,
// docs/schema/compare.schema.json). Based on: Vasilakis, Fudos, "Depth-Fighting Aware Methods for
// Multi-Fragment Rendering", TVCG 2014, section 4: Table 1, figures 7 to 9 and 11.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "pellucid/base.h"
#include "pellucid/metric.h"
#include "pellucid/render.h"
#include "pellucid/report.h"

namespace pellucid {

// ----------------------------------------------------------------------------------------------- heat maps

// A value of every pixel as a heat map, in the colours of overdraw (overdraw_report.h): white for zero, the
// darkest colour for the largest value. Of several samples per pixel, the first is shown.
struct NamedMap {
  std::string name;     // "importance", "k", "loss", "fragments", "coplanar"
  std::string caption;  // says what the darkest colour stands for
  Image image;
  std::string words, unit;  // "fragments lost to the tail", "fragments"
  double most = 0;          // what the darkest colour stands for
};
// Returns heat maps of importance, k and loss of a result that was drawn with BudgetOptions::maps; nothing
// without maps.
std::vector<NamedMap> budget_heat_maps(const RenderResult& result, std::uint32_t samples);
// Returns heat maps of the number of fragments, and of the number of coplanar fragments, of a result that was
// drawn with RenderOptions::keep_fragments; nothing without fragments.
std::vector<NamedMap> fragment_heat_maps(const RenderResult& result, std::uint32_t samples);

// ------------------------------------------------------------------------------------------------- a scene

// A heat map for the page.
struct ReportMap {
  std::string name, words, unit;  // "k", "slots for fragments of a pixel", "slots"
  double most = 0;                // what the darkest colour stands for
  std::vector<std::uint8_t> png;
};

struct ComparedTechnique {
  std::string name, title;
  bool exact = false;   // the technique promises to capture every fragment
  std::string failure;  // why the technique could not draw; empty: it did
  CaptureStats stats;   // milliseconds: the median of the frames
  std::optional<ImageError> error;
  // The image, and its difference from the exact image. The difference is left out if no pixel differs by
  // more than 1/255.
  std::vector<ReportImage> images;
  PerceivedError perceived{};
  std::optional<double> flicker{};  // over ComparedScene::flicker_frames frames
  std::vector<ReportMap> maps{};    // for techniques with a memory budget

  [[nodiscard]] bool drawn() const { return failure.empty(); }
  // Returns whether no pixel differs by more than 1/255 from the exact image.
  [[nodiscard]] bool equals_exact() const { return drawn() && error && error->differing == 0; }
};

struct ComparedScene {
  std::string input, camera;
  std::uint32_t width = 0, height = 0;
  std::uint64_t triangles = 0, objects = 0;
  std::string reference;  // the technique that drew the exact image: "sb", "cpu"
  CaptureStats exact;     // of that technique
  ReportImage image;      // the exact one
  std::uint32_t flicker_frames = 0;
  std::vector<std::uint64_t> pixels_by_depth;  // [n]: pixels with n fragments
  std::vector<ComparedTechnique> techniques;
  std::vector<std::string> notes;
  std::vector<ReportMap> maps{};  // fragments and coplanar fragments of every pixel, if there are any

  // Returns C_p of the paper: the share of covered pixels that have several fragments at one depth.
  [[nodiscard]] double coplanar_share() const;
  // Returns the mean number of fragments of a covered pixel.
  [[nodiscard]] double mean_depth() const;
  // Returns the fastest of the techniques that promise to capture everything and did; null if there is none.
  [[nodiscard]] const ComparedTechnique* fastest_exact() const;
  // Returns the time of a technique divided by that of fastest_exact(); nothing if either did not draw.
  [[nodiscard]] std::optional<double> time_ratio(const ComparedTechnique& technique) const;
};

// Returns the slots per pixel as "2" or "1-7"; "-" for techniques without slots.
std::string format_k_range(const CaptureStats& stats);

// ------------------------------------------------------------------------------------------------- sweeps

enum class SweepKind {
  resolution,   // number of pixels (figure 7)
  coplanarity,  // copies of the scene in one place (figure 8)
  depth,        // copies of the scene behind each other (figure 9)
  memory        // memory for fragments, as a share of what all fragments take (figure 11)
};
struct NamedSweep {
  SweepKind kind;
  std::string name, parameter;
};
std::span<const NamedSweep> compare_sweeps();

struct SweepPoint {
  double value = 0;  // of the parameter
  std::uint32_t width = 0, height = 0;
  std::uint64_t pool = 0;                         // nodes; 0: as many as there are fragments
  std::vector<std::optional<CaptureStats>> runs;  // one per technique; empty if it failed
};
struct ComparedSweep {
  SweepKind kind = SweepKind::resolution;
  std::string input;
  std::vector<std::string> techniques;
  std::vector<SweepPoint> points;
};

// ---------------------------------------------------------------------------------------------- the report

struct CompareReport {
  DeviceInfo device;
  std::string effect, surfaces;
  std::uint32_t k = 8, frames = 1;
  std::uint64_t memory = 0;  // BudgetOptions::bytes
  std::vector<ComparedScene> scenes;
  std::vector<ComparedSweep> sweeps;
  double seconds_total = 0;
  std::uint64_t peak_rss_bytes = 0;
};

// The results of a technique over all scenes of a report.
struct TechniqueSummary {
  std::string name;
  bool exact = false;  // the technique promises to capture every fragment
  std::uint32_t scenes = 0, drawn = 0;
  std::uint32_t equal = 0;           // number of scenes whose image equals the exact one
  std::optional<double> time_ratio;  // geometric mean over the scenes that have one
  std::optional<double> worst_psnr;
};
// Returns one summary per technique, in the order of the first scene that has it.
std::vector<TechniqueSummary> summarize(const CompareReport& report);

std::string to_text(const CompareReport& report);

// An image or heat map of a report, as a file of its own.
struct ImageFile {
  std::string path;                                // relative to the report: "images/NAME.png"
  const std::vector<std::uint8_t>* png = nullptr;  // points into the report
};
std::vector<ImageFile> image_files(const CompareReport& report);

// Whether the keys "picture" and "difference" of the JSON name the files of image_files(), which must then be
// written beside it, or are null.
enum class ImageLinks { none, beside };
std::string to_json(const CompareReport& report, ImageLinks links = ImageLinks::none);

// Returns one self-contained page. Its script lays any two images over each other. Everything else works
// without the script.
std::string compare_html(const CompareReport& report);

}  // namespace pellucid
