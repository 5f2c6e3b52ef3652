// Error against number of buffers, as a table and as JSON: see pellucid/frontier_report.h.
#include "pellucid/frontier_report.h"

#include <fmt/format.h>

#include "pellucid/report.h"
#include "report/json.h"

namespace pellucid {
namespace {

Json json_of(const FrontierPoint& point) {
  return {{"limit", point.limit},
          {"request", point.request},
          {"buffers", point.buffers},
          {"ipr", point.ipr},
          {"psnr", point.psnr},
          {"repaired", point.repaired},
          {"frame_time", point.frame_time},
          {"violated_weight", point.violated_weight},
          {"memory_bytes", point.memory_bytes},
          {"meets_target", point.meets_target}};
}

Json json_of(const PrimitiveFrontier& primitive) {
  const OrderFrontier& frontier = primitive.frontier;
  Json points = Json::array();
  for (const FrontierPoint& point : frontier.points) points.push_back(json_of(point));
  return {
      {"primitive", primitive.primitive}, {"name", primitive.name},
      {"triangles", primitive.triangles}, {"vertices", primitive.vertices},
      {"chosen", frontier.chosen},        {"knee", frontier.knee > 0 ? Json(frontier.knee) : Json(nullptr)},
      {"points", std::move(points)}};
}

std::string remark_on(const FrontierPoint& point, const OrderFrontier& frontier) {
  std::string text;
  const auto add = [&](const std::string& word) { text += (text.empty() ? "" : ", ") + word; };
  if (point.limit == frontier.chosen)
    add(point.meets_target ? "meets the target" : "more hardly help; misses the target");
  if (point.limit == frontier.knee) add("knee");
  if (point.request != point.limit) add(fmt::format("{} came out no worse", point.request));
  return text;
}

}  // namespace

std::string to_json(const FrontierReport& report) {
  Json distances = Json::array();
  for (const double distance : report.distances) distances.push_back(json_distance(distance));
  Json primitives = Json::array();
  for (const PrimitiveFrontier& primitive : report.primitives) primitives.push_back(json_of(primitive));
  const Json json = {
      {"schema", kJsonSchema},
      {"version", library_version()},
      {"input", report.input},
      {"method", "budget"},
      {"views", report.views},
      {"distances", std::move(distances)},
      {"seed", report.seed},
      {"alpha", report.alpha > 0 ? Json(report.alpha) : Json(nullptr)},
      {"picture_alpha", report.picture_alpha},
      {"max_error", report.min_psnr || report.least_frame_time ? Json(nullptr) : Json(report.max_error)},
      {"min_psnr", report.min_psnr ? Json(*report.min_psnr) : Json(nullptr)},
      {"primitives", std::move(primitives)}};
  return dump(json);
}

std::string to_text(const FrontierReport& report) {
  std::string text;
  for (const PrimitiveFrontier& primitive : report.primitives) {
    TextTable table({"buffers", "wrong pixels", "PSNR (dB)", "repaired pixels", "verified frame",
                     "violated weight", "memory", ""});
    for (const FrontierPoint& point : primitive.frontier.points) {
      table.add_row({std::to_string(point.limit), format_percent(point.ipr), format_fixed(point.psnr, 1),
                     format_percent(point.repaired), format_fixed(point.frame_time, 2),
                     format_percent(point.violated_weight), format_bytes(point.memory_bytes),
                     remark_on(point, primitive.frontier)});
    }
    text += fmt::format("{}: {} triangles, error against number of buffers\n{}", primitive.name,
                        format_count(primitive.triangles), table.to_string());
  }
  return text;
}

}  // namespace pellucid
