// Writes overdraw orders and the baselines as a table and JSON. In: an overdraw report
// (pellucid/overdraw_report.h). Out: text and JSON (docs/json.md).
#include "pellucid/overdraw_report.h"

#include <fmt/format.h>

#include "pellucid/report.h"
#include "report/json.h"

namespace pellucid {
namespace {

Json json_of(const OverdrawRow& row) {
  Json json = {{"acmr", row.acmr},
               {"overdraw_mean", row.key_frames.mean},
               {"overdraw_max", row.key_frames.max},
               {"buffer_count", row.buffers}};
  if (row.between) {
    json["between_mean"] = row.between->mean;
    json["between_max"] = row.between->max;
  }
  return json;
}

std::string excess_text(double overdraw) {
  return format_fixed(overdraw - 1, 5);
}

}  // namespace

std::string to_json(const OverdrawReport& report) {
  Json baselines = Json::object();
  for (std::size_t i = 1; i < report.rows.size(); ++i)
    baselines[report.rows[i].name] = json_of(report.rows[i]);
  Json clips = Json::array();
  for (const OverdrawReport::Clip& clip : report.clips)
    clips.push_back({{"name", clip.name}, {"key_frames", clip.key_frames}});
  Json by_frame = Json::object();
  for (const OverdrawRow& row : report.rows) by_frame[row.name] = row.key_frames.by_frame;
  Json frames = Json::array();
  for (const PosedFrame& frame : report.frames)
    frames.push_back({{"clip", frame.clip}, {"time", frame.time}});

  Json json = {
      {"schema", kJsonSchema},
      {"version", library_version()},
      {"input", report.input},
      {"output", report.output},
      {"files", report.files},
      {"method", report.method},
      {"lambda", report.lambda},
      {"cache", report.cache_size},
      {"viewpoints", report.viewpoints},
      {"size", report.size},
      {"seed", report.seed},
      {"joint", report.joint},
      {"whole", report.whole},
      {"triangles", report.triangles},
      {"vertices", report.vertices},
      {"parts", report.parts},
      {"patches", report.patches},
      {"nodes", report.views},
      {"training_nodes", report.training_views},
      {"iterations", report.iterations},
      {"clips", std::move(clips)},
      {"key_frames", report.frames.size()},
      {"measured", {{"viewpoints", report.measured_viewpoints}, {"pictures", report.measured_images}}}};
  if (!report.rows.empty()) {
    const OverdrawRow& own = report.rows.front();
    json["buffer_count"] = own.buffers;
    json["acmr"] = own.acmr;
    json["overdraw"] = {{"mean", own.key_frames.mean}, {"max", own.key_frames.max}};
    json["between_key_frames"] =
        own.between ? Json{{"mean", own.between->mean}, {"max", own.between->max}} : Json(nullptr);
  }
  json["baselines"] = std::move(baselines);
  json["by_key_frame"] = {{"frames", std::move(frames)}, {"overdraw", std::move(by_frame)}};
  json["memory_bytes"] = report.memory_bytes;
  json["disk_bytes"] = report.disk_bytes;
  json["file_bytes"] = report.file_bytes;
  json["seconds"] = {{"total", report.seconds_total},     {"read", report.seconds_read},
                     {"patches", report.seconds.patches}, {"raster", report.seconds.raster},
                     {"cluster", report.seconds.cluster}, {"assign", report.seconds.assign},
                     {"order", report.seconds.total},     {"measure", report.seconds_measure},
                     {"write", report.seconds_write},     {"rivals", report.seconds_baselines}};
  json["peak_rss_bytes"] = report.peak_rss_bytes;
  json["notes"] = report.notes;
  return dump(json);
}

std::string to_text(const OverdrawReport& report) {
  bool between = false;
  for (const OverdrawRow& row : report.rows) between = between || row.between.has_value();
  std::vector<std::string> header{"order", "buffers", "ACMR", "overdraw", "excess", "worst"};
  if (between) header.emplace_back("between keys");
  TextTable table(header);
  for (const OverdrawRow& row : report.rows) {
    std::vector<std::string> cells{row.name,
                                   std::to_string(row.buffers),
                                   format_fixed(row.acmr, 3),
                                   format_fixed(row.key_frames.mean, 4),
                                   excess_text(row.key_frames.mean),
                                   format_fixed(row.key_frames.max, 3)};
    if (between) cells.push_back(row.between ? format_fixed(row.between->mean, 4) : "-");
    table.add_row(std::move(cells));
  }
  std::string text = report.rows.empty() ? "" : table.to_string();
  const std::size_t frames = report.frames.size();
  text += fmt::format("{} triangles in {} patches, {} key frame{} x {} viewpoints; measured from {} others\n",
                      format_count(report.triangles), format_count(report.patches), format_count(frames),
                      frames == 1 ? "" : "s", report.viewpoints, report.measured_viewpoints);
  if (!report.output.empty()) {
    text += fmt::format("{}: {} ({} for orders)\n", report.output, format_bytes(report.file_bytes),
                        format_bytes(report.disk_bytes));
  }
  text +=
      fmt::format("{} in all (orders {}, what they are compared with {}, measured in {}), peak memory {}\n",
                  format_seconds(report.seconds_total), format_seconds(report.seconds.total),
                  format_seconds(report.seconds_baselines), format_seconds(report.seconds_measure),
                  format_bytes(report.peak_rss_bytes));
  return text;
}

}  // namespace pellucid
