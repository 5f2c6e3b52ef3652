// pellucid/report.h - module `report`: turns what was ordered and measured into tables, JSON, HTML pages and
// SVG plots.
//
// In: order sets and the results of the modules `transparency`, `metric` and `baseline`. Out: text. Nothing
// here draws, orders or measures. The keys of the JSON are a contract (docs/json.md). Reports of overdraw
// orders are in overdraw_report.h, those of capture techniques in compare_report.h.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "pellucid/asset.h"
#include "pellucid/base.h"
#include "pellucid/baseline.h"
#include "pellucid/mesh.h"
#include "pellucid/metric.h"
#include "pellucid/sequencing.h"
#include "pellucid/transparency.h"

namespace pellucid {

// Returns the version of the library, such as "0.1.0". Every report names it.
std::string_view library_version();

// ---------------------------------------------------------------------------------------------- plain text

// Return numbers with their units, as the comments show.
std::string format_bytes(std::uint64_t bytes);       // 12.3 KB (1 KB = 1000 bytes)
std::string format_seconds(double seconds);          // 0.042 s, 12.3 s, 4 min 05 s
std::string format_nanoseconds(double time);         // 87 ns, 12.3 us, 4.56 ms
std::string format_fixed(double value, int digits);  // "-" where the value is not finite
std::string format_percent(double ratio);            // 0.0123 -> 1.23 %

// Returns the text in a form that is safe as HTML content and in double-quoted attributes.
std::string escape_html(std::string_view text);

// A table whose columns are as wide as their widest cell. The first column is aligned to the left, the others
// to the right.
class TextTable {
 public:
  explicit TextTable(std::vector<std::string> header);
  // Adds a row, which is cut or filled up to the number of cells of the header.
  void add_row(std::vector<std::string> cells);
  [[nodiscard]] std::string to_string() const;

 private:
  std::vector<std::vector<std::string>> rows_;
};

// ------------------------------------------------------------------------------------------ pellucid order

// What splitting did to a primitive (pellucid/split.h).
struct SplitReport {
  std::uint64_t intersecting_pairs = 0, pairs_left = 0;
  std::uint32_t viewpoints = 0;  // number of viewpoints that were searched for cycles
  std::uint32_t cyclic_before = 0, cyclic_left = 0;
  std::uint64_t added_by_intersections = 0, added_by_cycles = 0;  // triangles
  bool limit_met = false;  // the limit of new triangles was reached before everything was cut
};

struct PrimitiveOrderReport {
  std::string name;
  std::uint32_t primitive = 0;
  std::uint64_t triangles = 0;  // ordered
  std::uint64_t vertices = 0;
  MeshReport check;        // of the input; triangles that draw nothing were left out
  double acmr_before = 0;  // of the order in the input
  std::vector<BufferStatistics> buffers;
  std::uint64_t memory_bytes = 0;  // index data when drawn
  OrderStatistics statistics;
  std::optional<OrderErrorRecord> error;  // over held-out viewpoints, if it was measured
  // Share of pixels, over the same viewpoints, that are wrong even in the best order found for each single
  // viewpoint. Negative: not measured.
  double ipr_unavoidable = -1;
  std::optional<SplitReport> split;
};

struct OrderReport {
  std::string input, output;
  std::string method, views;
  std::uint64_t seed = 0;
  std::uint32_t cache_size = 0;
  std::string cache_method;
  double alpha = 0;          // opacity that weights occlusions; 0: they are weighted by area
  double image_alpha = 0.5;  // opacity in the images that PSNR is measured on
  std::vector<double> distances;
  std::vector<PrimitiveOrderReport> primitives;
  std::uint64_t disk_bytes = 0;  // of the orders, as stored
  std::uint64_t file_bytes = 0;  // of all files written
  std::vector<std::string> files;
  std::vector<std::string> notes;
  double seconds_read = 0, seconds_validate = 0, seconds_write = 0, seconds_total = 0;
  std::uint64_t peak_rss_bytes = 0;
};
std::string to_text(const OrderReport& report);
// Returns one line: the output, its size, and the largest error of its primitives.
std::string to_line(const OrderReport& report);
std::string to_json(const OrderReport& report);

// The results of many files that were ordered in one call.
struct OrderFailure {
  std::string input, output;
  int exit_code = 1;  // the exit code for this file alone; with 5 the output was written all the same
  std::string message;
};
struct OrderBatchReport {
  std::uint64_t inputs = 0;
  std::vector<OrderReport> results;  // of all files that were written
  std::vector<OrderFailure> failures;
  std::vector<std::pair<std::string, std::string>> skipped;  // input, and the output that existed already
  bool interrupted = false;
  double seconds_total = 0;
  std::uint64_t peak_rss_bytes = 0;
};
std::string to_json(const OrderBatchReport& report);

// ------------------------------------------------------------- the Pareto front: error and number of buffers

struct PrimitiveFrontier {
  std::string name;
  std::uint32_t primitive = 0;
  std::uint64_t triangles = 0, vertices = 0;
  OrderFrontier frontier;
};

struct FrontierReport {
  std::string input, views;
  std::vector<double> distances;
  std::uint64_t seed = 0;
  double alpha = 0;          // as in OrderOptions
  double image_alpha = 0.5;  // opacity in the images that PSNR is measured on
  double max_error = 0.001;
  std::optional<double> min_psnr;  // replaces max_error
  bool least_frame_time = false;   // replaces both
  std::vector<PrimitiveFrontier> primitives;
};
std::string to_text(const FrontierReport& report);
// Returns JSON without times, so the same input, options and seed give the same bytes
// (docs/schema/frontier.schema.json).
std::string to_json(const FrontierReport& report);
// Returns one plot per primitive: error (logarithmic) and PSNR over the number of buffers, with the target,
// the chosen number and the knee. The SVG is self-contained, follows the light or dark scheme of the reader,
// and has no script and no fonts.
std::string frontier_svg(const FrontierReport& report);

// ---------------------------------------------------------------------------------------- pellucid measure

struct MeasureReport {
  std::vector<std::string> inputs;
  MeasureSettings settings;
  std::uint32_t overdraw_viewpoints = 0;
  std::vector<PrimitiveMeasureReport> primitives;
  double seconds_total = 0;
};

std::string to_text(const MeasureReport& report);
std::string to_json(const MeasureReport& report);

// An image of a report page.
struct ReportImage {
  std::string caption;
  std::vector<std::uint8_t> png;
};
struct ImageRow {
  std::string title;
  std::vector<ReportImage> images;
};
struct HtmlReportInput {
  std::string title;  // plain text, which is escaped
  const MeasureReport* measured = nullptr;
  std::size_t primitive = 0;         // the primitive that the images show
  const OrderSet* orders = nullptr;  // of the first method of that primitive
  std::span<const ImageRow> rows;
  std::string command;  // the command that makes this page
};
// Returns one self-contained page without scripts or network access. Images are data URIs, plots are inline
// SVG.
std::string html_report(const HtmlReportInput& input);

// ---------------------------------------------------------------------------------------- pellucid inspect

std::string inspect_text(const Model& model);
std::string inspect_json(const Model& model);

}  // namespace pellucid
