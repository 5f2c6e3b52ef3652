// Writes the quality of order sets and of the baselines as a table and as JSON. In: a measure report
// (pellucid/report.h). Out: text and JSON (docs/json.md).
#include <fmt/format.h>

#include <algorithm>

#include "pellucid/report.h"
#include "report/json.h"

namespace pellucid {
namespace {

Json ratio_json(const MethodQuality& quality) {
  Json by_distance = Json::array();
  for (const DistanceError& bin : quality.by_distance) {
    by_distance.push_back({{"distance", bin.distance}, {"ipr", bin.ipr}, {"psnr", bin.psnr}});
  }
  return {{"ipr", {{"mean", quality.ipr_mean}, {"max", quality.ipr_max}}},
          {"psnr", {{"mean", quality.psnr_mean}, {"min", quality.psnr_min}}},
          {"by_distance", std::move(by_distance)}};
}

Json json_of(const MethodReport& method) {
  Json json = ratio_json(method.quality);
  json["acmr"] = method.fifo.acmr;
  json["acmr_drawn"] = method.fifo.acmr_drawn;
  json["acmr_lru"] = method.acmr_lru;
  Json by_cache = Json::object();
  for (std::size_t i = 0; i < kReportedCaches.size(); ++i) {
    by_cache[std::string(kReportedCaches[i].name)] = method.acmr_by_cache[i];
  }
  json["acmr_by_cache"] = std::move(by_cache);
  json["atvr"] = method.atvr;
  json["overdraw"] = method.overdraw > 0 ? Json(method.overdraw) : Json(nullptr);
  json["buffer_count"] = method.buffers;
  json["memory_bytes"] = method.memory_bytes;
  json["auxiliary_bytes"] = method.auxiliary_bytes;
  json["build_seconds"] = method.build_seconds < 0 ? Json(nullptr) : Json(method.build_seconds);
  json["nanoseconds_per_frame"] = method.nanoseconds_per_frame;
  json["milliseconds_per_frame"] = 1e-6 * method.nanoseconds_per_frame;
  json["triangles_submitted"] = method.triangles_submitted;
  json["plane_tests"] = method.plane_tests;
  json["splits"] = method.splits;
  json["kind"] = method.kind == MethodKind::orders ? "orders" : "baseline";
  return json;
}

Json json_of(const PrimitiveMeasureReport& primitive) {
  Json methods = Json::object();
  for (const MethodReport& method : primitive.methods) methods[method.quality.name] = json_of(method);
  return {{"name", primitive.name},
          {"triangles", primitive.triangles},
          {"vertices", primitive.vertices},
          {"orders", std::move(methods)},
          {"notes", primitive.notes}};
}

// Returns the results of the method of that name over all primitives: means of means, and the worst of the
// worst values.
MethodReport pooled_method(const MeasureReport& report, const std::string& name) {
  MethodReport sum;
  double count = 0;
  std::vector<BufferStatistics> fifo;
  for (const PrimitiveMeasureReport& primitive : report.primitives) {
    for (const MethodReport& method : primitive.methods) {
      if (method.quality.name != name) continue;
      MethodQuality& into = sum.quality;
      const MethodQuality& from = method.quality;
      if (count == 0) {
        sum = method;
        sum.quality.frames.clear();
      } else {
        sum.buffers += method.buffers;
        sum.memory_bytes += method.memory_bytes;
        sum.auxiliary_bytes += method.auxiliary_bytes;
        sum.build_seconds += std::max(0.0, method.build_seconds);
        sum.nanoseconds_per_frame += method.nanoseconds_per_frame;
        sum.triangles_submitted += method.triangles_submitted;
        sum.plane_tests += method.plane_tests;
        sum.splits += method.splits;
        sum.acmr_lru += method.acmr_lru;
        for (std::size_t i = 0; i < sum.acmr_by_cache.size(); ++i) {
          sum.acmr_by_cache[i] += method.acmr_by_cache[i];
        }
        sum.atvr += method.atvr;
        sum.overdraw += method.overdraw;
        into.ipr_mean += from.ipr_mean;
        into.ipr_max = std::max(into.ipr_max, from.ipr_max);
        into.psnr_mean += from.psnr_mean;
        into.psnr_min = std::min(into.psnr_min, from.psnr_min);
        for (std::size_t i = 0; i < std::min(into.by_distance.size(), from.by_distance.size()); ++i) {
          into.by_distance[i].ipr += from.by_distance[i].ipr;
          into.by_distance[i].psnr += from.by_distance[i].psnr;
        }
      }
      fifo.push_back(method.fifo);
      ++count;
    }
  }
  sum.fifo = pooled(fifo);
  if (count > 1) {
    sum.acmr_lru /= count;
    for (double& acmr : sum.acmr_by_cache) acmr /= count;
    sum.atvr /= count;
    sum.overdraw /= count;
    sum.quality.ipr_mean /= count;
    sum.quality.psnr_mean /= count;
    for (DistanceError& bin : sum.quality.by_distance) {
      bin.ipr /= count;
      bin.psnr /= count;
    }
  }
  return sum;
}

void add_row(TextTable& table, const MethodReport& method) {
  table.add_row({method.quality.name, std::to_string(method.buffers), format_percent(method.quality.ipr_mean),
                 format_percent(method.quality.ipr_max), format_fixed(method.quality.psnr_mean, 1),
                 format_fixed(method.fifo.acmr, 3), format_fixed(method.fifo.acmr_drawn, 3),
                 format_fixed(method.atvr, 2), method.overdraw > 0 ? format_fixed(method.overdraw, 3) : "-",
                 format_bytes(method.memory_bytes + method.auxiliary_bytes),
                 method.build_seconds < 0 ? "-" : format_seconds(method.build_seconds),
                 format_nanoseconds(method.nanoseconds_per_frame)});
}

// Returns a table of ACMR by cache. It shows what an order costs with a cache that it was not optimised for.
std::string cache_table(const PrimitiveMeasureReport& primitive) {
  std::vector<std::string> header{"misses per triangle"};
  for (const ReportedCache& cache : kReportedCaches) {
    header.push_back(fmt::format("{} {}", cache.model == CacheModel::fifo ? "FIFO" : "LRU", cache.size));
  }
  TextTable table(header);
  for (const MethodReport& method : primitive.methods) {
    std::vector<std::string> row{method.quality.name};
    for (const double acmr : method.acmr_by_cache) row.push_back(format_fixed(acmr, 3));
    table.add_row(row);
  }
  return table.to_string();
}

}  // namespace

std::string to_json(const MeasureReport& report) {
  Json json = {{"schema", kJsonSchema},
               {"version", library_version()},
               {"input", report.inputs.empty() ? std::string() : report.inputs.front()},
               {"inputs", report.inputs}};
  Json methods = Json::object();
  if (!report.primitives.empty()) {
    const std::vector<MethodReport>& names = report.primitives.front().methods;
    for (const MethodReport& method : names) {
      methods[method.quality.name] = json_of(pooled_method(report, method.quality.name));
    }
    if (!names.empty()) json.update(json_of(pooled_method(report, names.front().quality.name)));
  }
  Json primitives = Json::array();
  for (const PrimitiveMeasureReport& primitive : report.primitives) primitives.push_back(json_of(primitive));
  json.erase("kind");
  json["viewpoints"] = report.settings.viewpoints;
  json["size"] = report.settings.size;
  json["distances"] = {report.settings.min_distance, report.settings.max_distance};
  json["cache"] = report.settings.cache_size;
  json["seed"] = report.settings.seed;
  json["alpha"] = report.settings.alpha;
  json["overdraw_viewpoints"] = report.overdraw_viewpoints;
  json["orders"] = std::move(methods);
  json["primitives"] = std::move(primitives);
  json["seconds"] = {{"total", report.seconds_total}};
  return dump(json);
}

std::string to_text(const MeasureReport& report) {
  std::string text;
  for (const PrimitiveMeasureReport& primitive : report.primitives) {
    text += fmt::format("{}: {} triangles, {} vertices\n", primitive.name, format_count(primitive.triangles),
                        format_count(primitive.vertices));
    TextTable table({"method", "buffers", "wrong", "worst", "PSNR", "ACMR", "per drawn", "ATVR", "overdraw",
                     "memory", "build", "per frame"});
    for (const MethodReport& method : primitive.methods) add_row(table, method);
    text += table.to_string() + "\n" + cache_table(primitive);
    for (const std::string& note : primitive.notes) text += note + "\n";
    text += "\n";
  }
  const MeasureSettings& settings = report.settings;
  text +=
      fmt::format("{} viewpoints at {}-{} bounding radii, {}x{}, FIFO {}, seed {}; {}\n", settings.viewpoints,
                  settings.min_distance, settings.max_distance, settings.size, settings.size,
                  settings.cache_size, settings.seed, format_seconds(report.seconds_total));
  return text;
}

}  // namespace pellucid
