// pellucid/report.h - module `report`: what was done and how good it is, as a table, JSON and one HTML page.
//
// In: order sets and what the modules `order` and `metric` say of them. Out: text. Nothing here draws or
// orders; the numbers come in, or are gathered by measure_subjects(). The keys of the JSON are a contract
// (docs/json.md).
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

// "0.1.0": written into every report.
std::string_view library_version();

// ---------------------------------------------------------------------------------------------- plain text

std::string format_bytes(std::uint64_t bytes);       // 12.3 KB (1 KB = 1000 bytes)
std::string format_seconds(double seconds);          // 0.042 s, 12.3 s, 4 min 05 s
std::string format_nanoseconds(double time);         // 87 ns, 12.3 us, 4.56 ms
std::string format_fixed(double value, int digits);  // "-" where the value is not finite
std::string format_percent(double ratio);            // 0.0123 -> 1.23 %

// Columns aligned by their widest cell: the first to the left, the others to the right.
class TextTable {
 public:
  explicit TextTable(std::vector<std::string> header);
  // As many cells as the header has.
  void add_row(std::vector<std::string> cells);
  [[nodiscard]] std::string to_string() const;

 private:
  std::vector<std::vector<std::string>> rows_;
};

// ------------------------------------------------------------------------------------------ pellucid order

// What --split did to a primitive.
struct SplitReport {
  std::uint64_t intersecting_pairs = 0, pairs_left = 0;
  std::uint32_t viewpoints = 0;  // that cycles were looked for from
  std::uint32_t cyclic_before = 0, cyclic_left = 0;
  std::uint64_t added_by_intersections = 0, added_by_cycles = 0;  // triangles
  bool limit_met = false;
};

struct PrimitiveOrderReport {
  std::string name;
  std::uint32_t primitive = 0;
  std::uint64_t triangles = 0;  // ordered
  std::uint64_t vertices = 0;
  MeshReport check;        // of the input; what is degenerate or not finite was dropped
  double acmr_before = 0;  // of the input's own order
  std::vector<BufferStatistics> buffers;
  std::uint64_t memory_bytes = 0;  // index data when drawn
  OrderStatistics statistics;
  std::optional<OrderErrorRecord> error;  // held-out viewpoints, when validated
  // Of these, share of pixels that stay wrong in the best order found for each viewpoint alone; < 0: not
  // measured.
  double ipr_unavoidable = -1;
  std::optional<SplitReport> split;
};

struct OrderReport {
  std::string input, output;
  std::string method, views;
  std::uint64_t seed = 0;
  std::uint32_t cache_size = 0;
  std::string cache_method;
  double alpha = 0, picture_alpha = 0.5;  // weights of occlusions (0: areas); pictures that PSNR is of
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
std::string to_line(const OrderReport& report);  // output, size and error of its worst primitive
std::string to_json(const OrderReport& report);

// Many files in one call.
struct OrderFailure {
  std::string input, output;
  int exit_code = 1;  // that of the file alone; 5: the output was written all the same
  std::string message;
};
struct OrderBatchReport {
  std::uint64_t inputs = 0;
  std::vector<OrderReport> results;  // of all files that were written
  std::vector<OrderFailure> failures;
  std::vector<std::pair<std::string, std::string>> skipped;  // input, output that was there
  bool interrupted = false;
  double seconds_total = 0;
  std::uint64_t peak_rss_bytes = 0;
};
std::string to_json(const OrderBatchReport& report);

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

// ------------------------------------------------------------------------------------------------ the page

struct ReportPicture {
  std::string caption;
  std::vector<std::uint8_t> png;
};
struct PictureRow {
  std::string title;
  std::vector<ReportPicture> pictures;
};
struct HtmlReportInput {
  std::string title;  // any text; escaped
  const MeasureReport* measured = nullptr;
  std::size_t primitive = 0;         // the one that the pictures show
  const OrderSet* orders = nullptr;  // of its first method
  std::span<const PictureRow> rows;
  std::string command;  // how to make this page again
};
// One self-contained page: no script, no network, pictures as data URIs, plots as inline SVG.
std::string html_report(const HtmlReportInput& input);

// Text made safe for HTML content and double-quoted attributes.
std::string escape_html(std::string_view text);

// ---------------------------------------------------------------------------------------- pellucid inspect

std::string inspect_text(const Model& model);
std::string inspect_json(const Model& model);

}  // namespace pellucid
