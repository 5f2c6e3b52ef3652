// pellucid/overdraw_report.h - module `report`: compares overdraw orders with the baselines, as a table, JSON
// and a page.
//
// In: measurements of a posed subject, its orders and the baselines, over held-out viewpoints and poses. Out:
// text and images. The keys of the JSON are a contract (docs/json.md). Based on: Han, Sander, "Triangle
// Reordering for Efficient Rendering in Complex Scenes", JCGT 6(3), 2017, figures 1 and 8.
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

// One row of the table: a method.
struct OverdrawRow {
  std::string name;
  std::uint32_t buffers = 1;
  double acmr = 0;
  OverdrawQuality key_frames;              // over held-out views of the key frames
  std::optional<OverdrawQuality> between;  // over held-out views of poses between key frames
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
  std::vector<Clip> clips;  // empty for a static mesh
  std::vector<PosedFrame> frames;
  std::uint64_t views = 0, training_views = 0;
  std::uint32_t iterations = 0;
  std::uint32_t measured_viewpoints = 0;
  std::uint64_t measured_images = 0;  // of all poses and viewpoints
  std::vector<OverdrawRow> rows;      // the orders that were made come first, then the baselines
  std::uint64_t memory_bytes = 0;     // of all index buffers, when drawn
  std::uint64_t disk_bytes = 0, file_bytes = 0;
  std::vector<std::string> files, notes;
  OverdrawSeconds seconds;       // to make the orders
  double seconds_baselines = 0;  // to make the baselines
  double seconds_read = 0, seconds_measure = 0, seconds_write = 0, seconds_total = 0;
  std::uint64_t peak_rss_bytes = 0;

  // Returns the number of key frames along the axis of overdraw_chart(), which is that of the longest row.
  [[nodiscard]] std::size_t charted_frames() const;
};
std::string to_text(const OverdrawReport& report);
std::string to_json(const OverdrawReport& report);

// ------------------------------------------------------------------------------------------------- images

// The heat map of one view: how many fragments of each pixel were shaded. It runs from pale (one fragment,
// which is necessary) to dark (many wasted fragments), as in figure 1 of the paper. `shaded` is what
// shaded_fragments() returns.
struct HeatMap {
  std::string label;       // "paper, run 0.40 s: 1.153"
  std::uint32_t size = 0;  // pixels per side
  std::vector<std::uint32_t> shaded;
};
// Returns one self-contained page: the table, overdraw over the animation (figure 8), and heat maps by method
// and frame, each with its overdraw.
std::string overdraw_html(const OverdrawReport& report, const std::vector<std::vector<HeatMap>>& sheet);
// Returns the heat maps as one image, with one row per method and one column per frame. Rows may differ in
// length, and maps in size. The image is empty if no map has a pixel. Throws Error{bad_argument} for a map
// that does not have size * size pixels.
Image contact_sheet(const std::vector<std::vector<HeatMap>>& sheet);

// An SVG element within an HTML page needs no namespace; an SVG file does.
enum class ChartPlace { file, page };
// Returns the mean overdraw of every row over the key frames, as SVG. For a single frame there is one bar per
// row. With more than 300 key frames, neighbours within a clip share a point.
std::string overdraw_chart(const OverdrawReport& report, ChartPlace place = ChartPlace::file);

}  // namespace pellucid
