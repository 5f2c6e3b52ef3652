// pellucid/overdraw_report.h - module `report`: overdraw orders beside the baselines, as a table, JSON and a
// page.
//
// In: a posed subject and the orders made for it. Out: what they cost on held-out views and poses, beside
// what programs do without them. The keys of the JSON are a contract (docs/json.md).
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "pellucid/base.h"
#include "pellucid/baseline.h"
#include "pellucid/metric.h"
#include "pellucid/overdraw.h"

namespace pellucid {

// One row of the table.
struct OverdrawRow {
  std::string name;
  std::uint32_t buffers = 1;
  double acmr = 0;
  OverdrawQuality key_frames;              // held-out views of the key frames
  std::optional<OverdrawQuality> between;  // held-out views of poses between key frames
};

struct OverdrawReport {
  std::string input, output, method;
  double lambda = 0.85;
  std::uint32_t cache_size = 16, viewpoints = 162, size = 256;
  std::uint64_t seed = 1;
  bool joint = true, whole = false;
  std::uint64_t triangles = 0, vertices = 0, parts = 0, patches = 0;
  struct Clip {
    std::string name;
    std::uint64_t key_frames = 0;
  };
  std::vector<Clip> clips;  // empty: a static mesh
  std::vector<PosedFrame> frames;
  std::uint64_t views = 0, training_views = 0;
  std::uint32_t iterations = 0;
  std::uint32_t measured_viewpoints = 0;
  std::uint64_t measured_pictures = 0;
  std::vector<OverdrawRow> rows;   // the orders that were made come first
  std::uint64_t memory_bytes = 0;  // of all index buffers, when drawn
  std::uint64_t disk_bytes = 0, file_bytes = 0;
  std::vector<std::string> files, notes;
  OverdrawSeconds seconds;    // of the orders
  double seconds_rivals = 0;  // what the orders are compared with
  double seconds_read = 0, seconds_measure = 0, seconds_write = 0, seconds_total = 0;
  std::uint64_t peak_rss_bytes = 0;
};
std::string to_text(const OverdrawReport& report);
std::string to_json(const OverdrawReport& report);

// ----------------------------------------------------------------------------------------------- pictures

// The picture of one view: how often a pixel was shaded in vain, from pale (never) to dark (figure 1 of the
// paper). `shaded` as shaded_fragments() gives it.
struct HeatMap {
  std::string label;       // "paper, run 0.40 s: 1.153"
  std::uint32_t size = 0;  // pixels a side
  std::vector<std::uint32_t> shaded;
};
// One self-contained page: the table, overdraw over the animation (figure 8), heat maps method by method and
// frame by frame, each with its overdraw.
std::string overdraw_html(const OverdrawReport& report, const std::vector<std::vector<HeatMap>>& sheet);
// The heat maps as one picture: a row per method, a column per frame. Rows may differ in length, and maps in
// size. Empty without any pixel. Throws Error{bad_argument} for maps that have not size * size pixels.
Image contact_sheet(const std::vector<std::vector<HeatMap>>& sheet);
// Mean overdraw of every row, key frame by key frame, as an SVG; of a single frame, a bar per row. Beyond 300
// key frames, neighbours within a clip share a point.
std::string overdraw_chart(const OverdrawReport& report);

}  // namespace pellucid
