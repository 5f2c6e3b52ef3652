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
#include "pellucid/mesh.h"
#include "pellucid/metric.h"
#include "pellucid/order.h"

namespace pellucid {

// "0.1.0": written into every report.
std::string_view library_version();

// ---------------------------------------------------------------------------------------------- plain text

std::string format_count(std::uint64_t count);       // 12,345
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

// How one index buffer uses a vertex cache.
struct BufferStatistics {
  std::uint64_t triangles = 0;  // in the list, facing twins counted
  std::uint64_t misses = 0;
  double acmr = 0;        // misses per triangle of the list
  double acmr_drawn = 0;  // misses per distinct triangle: the twin that faces away is culled, yet transformed
};
BufferStatistics sequence_statistics(const Mesh& mesh, std::span<const NodeId> sequence, CacheModel model,
                                     std::uint32_t cache_size);
std::vector<BufferStatistics> buffer_statistics(const Mesh& mesh, const OrderSet& orders, CacheModel model,
                                                std::uint32_t cache_size);
// All buffers as one: ratios over the sums.
BufferStatistics pooled(std::span<const BufferStatistics> buffers);

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

// A mesh as one file draws it. `orders` null: the file's own triangle order is all there is.
struct MeasureSubject {
  std::string label;
  const Mesh* mesh = nullptr;        // clean
  const OrderSet* orders = nullptr;  // nodes refer to `mesh`
};

// Rivals to measure beside the order sets.
struct Baselines {
  bool base = true, cache_optimized = true, centroid_sort = true;
  bool bsp = false, dptl = false;  // take time and memory to build
};
// "all", "none", or names with commas: "base,cache_optimized,centroid_sort,bsp,dptl". Throws
// Error{bad_argument}.
Baselines parse_baselines(const std::string& text);
// Names that methods of any choice may have.
std::span<const std::string_view> baseline_names();

struct MeasureSettings {
  std::uint32_t viewpoints = 900;
  double min_distance = 2, max_distance = 5;
  std::uint32_t size = 1024;
  std::uint64_t seed = 20180501;
  std::uint32_t cache_size = 20;
  double alpha = 0.5;
  Baselines baselines{};
};

enum class MethodKind { orders, baseline };

// Caches that every method's ACMR is reported for, so that a reader sees what tuning for one size costs with
// another.
struct ReportedCache {
  CacheModel model;
  std::uint32_t size;
  std::string_view name;
};
constexpr std::array<ReportedCache, 5> kReportedCaches{{{CacheModel::fifo, 16, "fifo16"},
                                                        {CacheModel::fifo, 20, "fifo20"},
                                                        {CacheModel::fifo, 32, "fifo32"},
                                                        {CacheModel::lru, 16, "lru16"},
                                                        {CacheModel::lru, 32, "lru32"}}};

struct MethodReport {
  MethodKind kind = MethodKind::orders;
  std::uint32_t buffers = 1;
  std::uint64_t memory_bytes = 0;     // index data when drawn
  std::uint64_t auxiliary_bytes = 0;  // what else it needs: tables, planes, trees, centroids, new vertices
  double build_seconds = -1;          // wall time of making it in this run; < 0: nothing was made
  double nanoseconds_per_frame = 0;   // CPU work before a frame can be drawn
  double triangles_submitted = 0;     // per frame, facing twins counted
  double plane_tests = 0;             // per frame
  std::uint64_t splits = 0;           // triangles and pieces that were cut in two
  BufferStatistics fifo;              // all buffers pooled
  double acmr_lru = 0;
  std::array<double, kReportedCaches.size()> acmr_by_cache{};
  double atvr = 0;
  double overdraw = 0;
  MethodQuality quality;  // carries the name
};

struct PrimitiveMeasureReport {
  std::string name;
  std::uint64_t triangles = 0, vertices = 0;
  std::vector<MethodReport> methods;  // the order sets first, then the baselines
  std::vector<std::string> notes;     // what was asked for and left out, and why
};

struct MeasureReport {
  std::vector<std::string> inputs;
  MeasureSettings settings;
  std::uint32_t overdraw_viewpoints = 0;
  std::vector<PrimitiveMeasureReport> primitives;
  double seconds_total = 0;
};

// Measure every subject that has orders, and beside them the rivals of the first subject's mesh: `original`
// (the triangle order of `original`, drawn as viewers draw it: later triangles over earlier ones; null: left
// out), `base` (the best single order of the set), `cache_optimized` (meshoptimizer's unconstrained vertex
// cache order of all triangles), `cache_optimized_twins` (the same of every buffer of the set, with the nodes
// that it holds: what its constraints cost), `centroid_sort` (sorted for every frame), `bsp` (walk of a
// binary space partition) and `dptl` (depth-presorted triangle lists). The first subject decides the facing.
PrimitiveMeasureReport measure_subjects(std::span<const MeasureSubject> subjects, const Mesh* original,
                                        const std::string& name, const MeasureSettings& settings,
                                        Progress* progress);
// Viewpoints that overdraw is counted on: the first of those that quality is measured on.
std::uint32_t overdraw_viewpoints(const MeasureSettings& settings);

std::string to_text(const MeasureReport& report);
std::string to_json(const MeasureReport& report);

// Ranks of all nodes when the order set is drawn from a viewpoint: its order, or the base order inside
// valid_from.
std::vector<std::uint32_t> ranks_from(const Mesh& mesh, const OrderSet& orders, const Viewpoint& viewpoint);
// Ranks of both facings when whole triangles are drawn front to back in this sequence.
std::vector<std::uint32_t> ranks_of_triangles(std::span<const std::uint32_t> sequence,
                                              std::uint64_t triangle_count);
// The triangle order of the file as viewers blend it: the last triangle is the nearest.
std::vector<std::uint32_t> ranks_as_stored(std::uint64_t triangle_count);
// Baseline: triangles in meshoptimizer's vertex cache order, which knows nothing of depth.
std::vector<std::uint32_t> cache_optimized_sequence(const Mesh& mesh);
// The same nodes in meshoptimizer's vertex cache order.
NodeSequence cache_optimized_nodes(const Mesh& mesh, const NodeSequence& nodes);

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
