// pellucid/compare_report.h - module `report`: capture techniques side by side, as a table, JSON and a page.
//
// In: what every technique captured of a scene, how long it took, and its picture; the same over a parameter
// that is swept. Out: text. The keys of the JSON are a contract (docs/json.md,
// docs/schema/compare.schema.json). Paper: Vasilakis, Fudos, "Depth-Fighting Aware Methods for
// Multi-Fragment Rendering", TVCG 2014, section 4: Table 1, figures 7 to 9 and 11.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "pellucid/metric.h"
#include "pellucid/render.h"
#include "pellucid/report.h"

namespace pellucid {

// ------------------------------------------------------------------------------------ pictures and errors

// ------------------------------------------------------------------------------------------------- a scene

// A heat map for the page: white where there is none, then darker for more.
struct ReportMap {
  std::string name, words, unit;  // "k", "slots for fragments of a pixel", "slots"
  double most = 0;                // what the darkest colour stands for
  std::vector<std::uint8_t> png;
};

struct ComparedTechnique {
  std::string name, title;
  bool exact = false;   // by what it promises
  std::string failure;  // why there is nothing else; empty: it was drawn
  CaptureStats stats;   // milliseconds: the median of the frames
  std::optional<ImageError> error;
  // What it drew, and the difference from the exact picture. Empty where it differs nowhere by more than
  // 1/255.
  std::vector<ReportPicture> pictures;
  PerceivedError perceived{};
  std::optional<double> flicker{};  // of the frames of ComparedScene::flicker_frames
  std::vector<ReportMap> maps{};    // of techniques with a budget

  [[nodiscard]] bool drawn() const { return failure.empty(); }
  // No pixel differs by more than 1/255 from the exact picture.
  [[nodiscard]] bool equals_exact() const { return drawn() && error && error->differing == 0; }
};

struct ComparedScene {
  std::string input, camera;
  std::uint32_t width = 0, height = 0;
  std::uint64_t triangles = 0, objects = 0;
  std::string reference;  // what the exact picture was drawn by: "sb", "cpu"
  CaptureStats exact;     // of that
  ReportPicture picture;
  std::uint32_t flicker_frames = 0;
  std::vector<std::uint64_t> pixels_by_depth;  // [n]: pixels with n fragments
  std::vector<ComparedTechnique> techniques;
  std::vector<std::string> notes;
  std::vector<ReportMap> maps{};  // fragments, and coplanar ones, of every pixel, where there are any

  // The paper's C_p: share of covered pixels with fragments at one depth.
  [[nodiscard]] double coplanar_share() const;
  [[nodiscard]] double mean_depth() const;  // fragments of a covered pixel
  // Of those that captured everything and promise to; null: none.
  [[nodiscard]] const ComparedTechnique* fastest_exact() const;
  // Of a technique's time to that one's; none where either is not there.
  [[nodiscard]] std::optional<double> time_ratio(const ComparedTechnique& technique) const;
};

// "2", "1-7"; "-" for techniques that give no slots.
std::string format_k_range(const CaptureStats& stats);

// ------------------------------------------------------------------------------------------------- sweeps

enum class SweepKind {
  resolution,   // pixels of the picture (figure 7)
  coplanarity,  // copies of the scene in one place (figure 8)
  depth,        // copies behind each other (figure 9)
  memory        // for fragments, as a share of what all of them take (figure 11)
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
  std::vector<std::optional<CaptureStats>> runs;  // of every technique; none: it failed
};
struct ComparedSweep {
  SweepKind kind = SweepKind::resolution;
  std::string input;
  std::vector<std::string> techniques;
  std::vector<SweepPoint> points;
};

// ------------------------------------------------------------------------------------------------ the report

struct CompareReport {
  DeviceInfo device;
  std::string effect, surfaces;
  std::uint32_t k = 8, frames = 1;
  std::uint64_t memory = 0;  // RenderOptions::memory
  std::vector<ComparedScene> scenes;
  std::vector<ComparedSweep> sweeps;
  double seconds_total = 0;
  std::uint64_t peak_rss_bytes = 0;
};

// A technique over all scenes of a report.
struct TechniqueSummary {
  std::string name;
  bool exact = false;  // by what it promises
  std::uint32_t scenes = 0, drawn = 0;
  std::uint32_t equal = 0;           // of those drawn: like the exact picture
  std::optional<double> time_ratio;  // geometric mean over the scenes that have one
  std::optional<double> worst_psnr;
};
// In the sequence of the first scene that has them.
std::vector<TechniqueSummary> summarize(const CompareReport& report);

std::string to_text(const CompareReport& report);

// Where the pictures of a report are: keys "picture" and "difference" of its JSON. `none`: nowhere.
enum class ImageFiles { none, beside };
std::string to_json(const CompareReport& report, ImageFiles images = ImageFiles::none);

// All pictures and heat maps as files of their own, by a path from the report's folder: "images/NAME.png".
struct ImageFile {
  std::string path;
  const std::vector<std::uint8_t>* png = nullptr;  // the report's
};
std::vector<ImageFile> image_files(const CompareReport& report);

// One self-contained page. Its script lets any two pictures be laid over each other; all else works without
// it.
std::string compare_html(const CompareReport& report);

}  // namespace pellucid
