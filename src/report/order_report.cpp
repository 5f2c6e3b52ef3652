// Writes what was ordered, for one file or many, as a table, one line and JSON. In: order reports
// (pellucid/report.h). Out: text and JSON (docs/json.md).
#include <fmt/format.h>

#include <algorithm>

#include "pellucid/report.h"
#include "report/json.h"

namespace pellucid {
namespace {

// ---------------------------------------------------------------------------------------------------- JSON

Json json_of(const BufferStatistics& buffer) {
  return {{"triangles", buffer.triangles},
          {"acmr", buffer.acmr},
          {"acmr_drawn", buffer.acmr_drawn},
          {"misses", buffer.misses}};
}

Json json_of(const OrderErrorRecord& error) {
  Json by_distance = Json::array();
  for (const auto& bin : error.by_distance)
    by_distance.push_back({{"distance", bin.distance}, {"ipr", bin.ipr}});
  return {{"viewpoints", error.viewpoints},
          {"size", error.size},
          {"ipr", {{"mean", error.ipr_mean}, {"max", error.ipr_max}}},
          {"psnr", {{"mean", error.psnr_mean}}},
          {"by_distance", std::move(by_distance)}};
}

Json json_of(const SplitReport& split) {
  return {{"intersecting_pairs", {{"before", split.intersecting_pairs}, {"after", split.pairs_left}}},
          {"cyclic_viewpoints",
           {{"of", split.viewpoints}, {"before", split.cyclic_before}, {"after", split.cyclic_left}}},
          {"added_triangles",
           {{"intersections", split.added_by_intersections}, {"cycles", split.added_by_cycles}}},
          {"limit_met", split.limit_met}};
}

// Returns null for values below 0, which means that they were not measured.
Json json_or_null(double value) {
  return value < 0 ? Json(nullptr) : Json(value);
}

Json json_of(const PrimitiveOrderReport& primitive) {
  const OrderStatistics& s = primitive.statistics;
  const BufferStatistics pool = pooled(primitive.buffers);
  Json buffers = Json::array();
  for (const BufferStatistics& buffer : primitive.buffers) buffers.push_back(json_of(buffer));
  Json json = {
      {"primitive", primitive.primitive},
      {"name", primitive.name},
      {"triangles", primitive.triangles},
      {"vertices", primitive.vertices},
      {"check", json_of(primitive.check)},
      {"buffer_count", primitive.buffers.size()},
      {"buffers", std::move(buffers)},
      {"acmr_before", primitive.acmr_before},
      {"acmr", pool.acmr},
      {"acmr_drawn", pool.acmr_drawn},
      {"memory_bytes", primitive.memory_bytes},
      {"viewpoints", s.viewpoints},
      {"edges_per_viewpoint", s.edges_per_viewpoint},
      {"edges_total", s.edges_total},
      {"intersecting_pairs", s.intersecting_pairs},
      {"dropped_edges", {{"count", s.dropped_edges}, {"weight", s.dropped_weight}}},
      {"cyclic_cells", s.cyclic_cells},
      {"violated_weight", s.violated_weight},
      {"violated_floor", s.violated_floor},
      {"violated_bound", s.violated_bound},
      {"regions", s.regions},
      {"switches_per_turn", s.switches_per_turn},
      {"clusters_lower_bound", s.clusters_lower_bound == 0 ? Json(nullptr) : Json(s.clusters_lower_bound)},
      {"clusters_before_relaxation", s.clusters_before_relaxation},
      {"iterations", s.iterations},
      {"training_ipr", json_or_null(s.measured_error)},
      {"training_psnr", json_or_null(s.measured_psnr)},
      {"error", primitive.error ? json_of(*primitive.error) : Json(nullptr)},
      {"ipr_unavoidable", json_or_null(primitive.ipr_unavoidable)},
      {"split", primitive.split ? json_of(*primitive.split) : Json(nullptr)},
      {"seconds",
       {{"total", s.seconds.total},
        {"graph", s.seconds.graph},
        {"cluster", s.seconds.cluster},
        {"sequence", s.seconds.sequence},
        {"refine", s.seconds.refine}}}};
  return json;
}

Json json_of(const OrderReport& report) {
  std::uint64_t triangles = 0;
  std::uint64_t vertices = 0;
  std::uint64_t memory = 0;
  std::uint64_t dropped = 0;
  double dropped_weight = 0;
  std::uint64_t cyclic_cells = 0;
  StageSeconds stages;
  Json buffers = Json::array();
  Json primitives = Json::array();
  for (const PrimitiveOrderReport& primitive : report.primitives) {
    triangles += primitive.triangles;
    vertices += primitive.vertices;
    memory += primitive.memory_bytes;
    dropped += primitive.statistics.dropped_edges;
    // Shares cannot be added up. The mean weighted by triangles shows what a typical primitive lost.
    dropped_weight += primitive.statistics.dropped_weight * static_cast<double>(primitive.triangles);
    cyclic_cells += primitive.statistics.cyclic_cells;
    stages.graph += primitive.statistics.seconds.graph;
    stages.cluster += primitive.statistics.seconds.cluster;
    stages.sequence += primitive.statistics.seconds.sequence;
    stages.refine += primitive.statistics.seconds.refine;
    for (const BufferStatistics& buffer : primitive.buffers) {
      Json json = json_of(buffer);
      json["primitive"] = primitive.primitive;
      buffers.push_back(std::move(json));
    }
    primitives.push_back(json_of(primitive));
  }
  if (triangles > 0) dropped_weight /= static_cast<double>(triangles);
  Json distances = Json::array();
  for (const double distance : report.distances) distances.push_back(json_distance(distance));

  return {{"schema", kJsonSchema},
          {"version", library_version()},
          {"input", report.input},
          {"output", report.output},
          {"files", report.files},
          {"triangles", triangles},
          {"vertices", vertices},
          {"method", report.method},
          {"views", report.views},
          {"distances", std::move(distances)},
          {"cache", report.cache_size},
          {"cache_method", report.cache_method},
          {"alpha", report.alpha > 0 ? Json(report.alpha) : Json(nullptr)},
          {"picture_alpha", report.image_alpha},
          {"seed", report.seed},
          {"buffer_count", buffers.size()},
          {"buffers", buffers},
          {"memory_bytes", memory},
          {"disk_bytes", report.disk_bytes},
          {"file_bytes", report.file_bytes},
          {"dropped_edges", {{"count", dropped}, {"weight", dropped_weight}}},
          {"cyclic_cells", cyclic_cells},
          {"seconds",
           {{"total", report.seconds_total},
            {"read", report.seconds_read},
            {"graph", stages.graph},
            {"cluster", stages.cluster},
            {"sequence", stages.sequence},
            {"refine", stages.refine},
            {"validate", report.seconds_validate},
            {"write", report.seconds_write}}},
          {"peak_rss_bytes", report.peak_rss_bytes},
          {"primitives", std::move(primitives)},
          {"notes", report.notes}};
}

// ---------------------------------------------------------------------------------------------------- text

std::string problems_of(const MeshReport& check) {
  std::string text;
  const auto add = [&](std::uint64_t count, const char* what) {
    if (count > 0) text += (text.empty() ? "" : ", ") + format_count(count) + " " + what;
  };
  add(check.out_of_range, "out of range");
  add(check.non_finite, "not finite");
  add(check.degenerate, "degenerate");
  return text;
}

// Returns what splitting did, and the pixels that no order draws correctly.
std::string unordered_text(const PrimitiveOrderReport& primitive) {
  std::string text;
  if (primitive.split) {
    const SplitReport& split = *primitive.split;
    text += fmt::format(
        "{}: split: intersecting pairs {}, left {}; viewpoints with cycles {} of {}, left {}; {} triangles "
        "added{}\n",
        primitive.name, format_count(split.intersecting_pairs), format_count(split.pairs_left),
        split.cyclic_before, split.viewpoints, split.cyclic_left,
        format_count(split.added_by_intersections + split.added_by_cycles),
        split.limit_met ? ", which is the limit of new triangles" : "");
  }
  if (primitive.ipr_unavoidable > 0) {
    text +=
        fmt::format("{}: wrong pixels that no order avoids, as faces intersect or overlap in cycles: {}{}\n",
                    primitive.name, format_percent(primitive.ipr_unavoidable),
                    primitive.split ? "" : " (splitting cuts them)");
  }
  return text;
}

std::string bounds_of(const PrimitiveOrderReport& primitive) {
  const OrderStatistics& s = primitive.statistics;
  std::string text = fmt::format(
      "{}: {} of the overlapped area in the wrong order at the samples (at least {} for these clusters, {} "
      "for any number of buffers); {} regions, {} switches a turn",
      primitive.name, format_percent(s.violated_weight), format_percent(s.violated_bound),
      format_percent(s.violated_floor), s.regions, format_fixed(s.switches_per_turn, 1));
  if (s.clusters_lower_bound > 0)
    text += fmt::format("; at least {} acyclic buffers", s.clusters_lower_bound);
  return text + "\n";
}

}  // namespace

std::string to_json(const OrderReport& report) {
  return dump(json_of(report));
}

std::string to_text(const OrderReport& report) {
  TextTable table({"primitive", "triangles", "buffers", "ACMR before", "ACMR", "per drawn", "memory", "graph",
                   "cluster", "sequence", "wrong pixels"});
  for (const PrimitiveOrderReport& primitive : report.primitives) {
    const BufferStatistics pool = pooled(primitive.buffers);
    const StageSeconds& seconds = primitive.statistics.seconds;
    std::string error = "-";
    if (primitive.error) {
      error = format_percent(primitive.error->ipr_mean);
    } else if (primitive.statistics.measured_error >= 0) {
      error = format_percent(primitive.statistics.measured_error);
    }
    table.add_row({primitive.name, format_count(primitive.triangles),
                   std::to_string(primitive.buffers.size()), format_fixed(primitive.acmr_before, 3),
                   format_fixed(pool.acmr, 3), format_fixed(pool.acmr_drawn, 3),
                   format_bytes(primitive.memory_bytes), format_seconds(seconds.graph),
                   format_seconds(seconds.cluster), format_seconds(seconds.sequence), error});
  }
  std::string text = table.to_string();
  for (const PrimitiveOrderReport& primitive : report.primitives) {
    const std::string problems = problems_of(primitive.check);
    if (!problems.empty()) text += fmt::format("{}: left out triangles: {}\n", primitive.name, problems);
    text += bounds_of(primitive);
    if (primitive.error) {
      text +=
          fmt::format("{}: {} held-out viewpoints at {}x{}: wrong pixels mean {}, worst {}; PSNR {} dB\n",
                      primitive.name, primitive.error->viewpoints, primitive.error->size,
                      primitive.error->size, format_percent(primitive.error->ipr_mean),
                      format_percent(primitive.error->ipr_max), format_fixed(primitive.error->psnr_mean, 1));
    }
    text += unordered_text(primitive);
  }
  text += fmt::format("{}: {} ({} for orders), method {}, views {}, seed {}\n", report.output,
                      format_bytes(report.file_bytes), format_bytes(report.disk_bytes), report.method,
                      report.views, report.seed);
  text += fmt::format("{} in all (read {}, validate {}, write {}), peak memory {}\n",
                      format_seconds(report.seconds_total), format_seconds(report.seconds_read),
                      format_seconds(report.seconds_validate), format_seconds(report.seconds_write),
                      format_bytes(report.peak_rss_bytes));
  return text;
}

std::string to_json(const OrderBatchReport& report) {
  Json results = Json::array();
  for (const OrderReport& result : report.results) results.push_back(json_of(result));
  Json failures = Json::array();
  for (const OrderFailure& failure : report.failures) {
    failures.push_back({{"input", failure.input},
                        {"output", failure.output},
                        {"exit_code", failure.exit_code},
                        {"message", failure.message}});
  }
  Json skipped = Json::array();
  for (const auto& [input, output] : report.skipped)
    skipped.push_back({{"input", input}, {"output", output}});
  return dump({{"schema", kJsonSchema},
               {"version", library_version()},
               {"inputs", report.inputs},
               {"interrupted", report.interrupted},
               {"results", std::move(results)},
               {"failures", std::move(failures)},
               {"skipped", std::move(skipped)},
               {"seconds", {{"total", report.seconds_total}}},
               {"peak_rss_bytes", report.peak_rss_bytes}});
}

std::string to_line(const OrderReport& report) {
  std::uint64_t triangles = 0;
  std::size_t buffers = 0;
  double error = -1;
  for (const PrimitiveOrderReport& primitive : report.primitives) {
    triangles += primitive.triangles;
    buffers += primitive.buffers.size();
    error =
        std::max(error, primitive.error ? primitive.error->ipr_mean : primitive.statistics.measured_error);
  }
  return fmt::format("{}: {} triangles, {} buffer(s), {}, wrong pixels {}, {}\n", report.output,
                     format_count(triangles), buffers, format_bytes(report.disk_bytes),
                     error < 0 ? "-" : format_percent(error), format_seconds(report.seconds_total));
}

}  // namespace pellucid
