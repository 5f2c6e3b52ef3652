// Writes a comparison of capture techniques as a table and JSON, and lists the paths of their images. In: a
// comparison (pellucid/compare_report.h). Out: text and JSON (docs/json.md).
#include "pellucid/compare_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <filesystem>

#include "report/json.h"

namespace pellucid {
namespace {

// --------------------------------------------------------------------------------------------- image files

// Returns the name of a file in characters that every file system and shell accepts.
std::string plain_name(const std::string& input) {
  std::string name = std::filesystem::path(input).stem().string();
  for (char& c : name) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte >= 0x80U || (std::isalnum(byte) == 0 && c != '-' && c != '_' && c != '.')) c = '_';
  }
  return name;
}

// Returns a path such as "images/stack-f2b-difference.png" for `what` = "f2b-difference". It includes the
// number of the scene if there are several.
std::string image_path(const CompareReport& report, std::size_t scene, const std::string& what) {
  const std::string name = plain_name(report.scenes[scene].input);
  return report.scenes.size() == 1 ? fmt::format("images/{}-{}.png", name, what)
                                   : fmt::format("images/{}-{}-{}.png", scene + 1, name, what);
}

// ------------------------------------------------------------------------------ techniques over all scenes

// A summary, with the sums that its geometric mean is made of.
struct Gathered {
  TechniqueSummary summary;
  double log_ratios = 0;
  std::uint32_t ratios = 0;
};

Gathered& entry_of(std::vector<Gathered>& all, const ComparedTechnique& technique) {
  for (Gathered& one : all)
    if (one.summary.name == technique.name) return one;
  Gathered& added = all.emplace_back();
  added.summary.name = technique.name;
  added.summary.exact = technique.exact;
  return added;
}

void gather(const ComparedTechnique& technique, const ComparedScene& scene, Gathered& into) {
  TechniqueSummary& summary = into.summary;
  ++summary.scenes;
  if (!technique.drawn()) return;
  ++summary.drawn;
  summary.equal += technique.equals_exact() ? 1U : 0U;
  if (technique.error)
    summary.worst_psnr = std::min(summary.worst_psnr.value_or(INFINITY), technique.error->psnr);
  if (const std::optional<double> ratio = scene.time_ratio(technique); ratio && *ratio > 0) {
    into.log_ratios += std::log(*ratio);
    ++into.ratios;
  }
}

// ---------------------------------------------------------------------------------------------------- JSON

double pixels_of(const ComparedScene& scene) {
  return static_cast<double>(scene.width) * scene.height;
}

Json or_null(std::optional<double> value) {
  return value ? Json(*value) : Json(nullptr);
}

// Returns the keys that a technique that failed also has, with the value null.
Json json_of_stats(const CaptureStats& stats, double pixels) {
  return {{"milliseconds", stats.milliseconds},
          {"passes", stats.geometry_passes},
          {"fullscreen_passes", stats.fullscreen_passes},
          {"rounds", stats.rounds},
          {"bytes", stats.bytes},
          {"bytes_per_pixel", static_cast<double>(stats.bytes) / pixels},
          {"total", stats.fragments},
          {"captured", stats.captured},
          {"lost", stats.fragments - std::min(stats.fragments, stats.captured)},
          {"overflowed", stats.overflowed},
          {"repaired_pixels", stats.repaired_pixels},
          {"misordered_pixels", stats.misordered_pixels},
          {"r_h", stats.captured_share()},
          {"coplanar", stats.coplanar},
          {"coplanar_pixels", stats.coplanar_pixels},
          {"k_least", stats.k_least ? Json(*stats.k_least) : Json(nullptr)},
          {"k_most", stats.k_most ? Json(*stats.k_most) : Json(nullptr)},
          {"k_mean", stats.k_mean() ? Json(*stats.k_mean()) : Json(nullptr)},
          {"chosen", stats.chosen.empty() ? Json(nullptr) : Json(stats.chosen)},
          {"reason", stats.reason.empty() ? Json(nullptr) : Json(stats.reason)}};
}

void append(Json& json, Json more, bool known) {
  for (auto& [key, value] : more.items()) json[key] = known ? std::move(value) : Json(nullptr);
}

Json json_of(const ComparedTechnique& technique, const ComparedScene& scene) {
  const bool drawn = technique.drawn();
  Json json = {{"name", technique.name},
               {"exact", technique.exact},
               {"failure", drawn ? Json(nullptr) : Json(technique.failure)}};
  append(json, json_of_stats(technique.stats, pixels_of(scene)), drawn);
  json["ratio"] = or_null(scene.time_ratio(technique));
  const auto error = [&](auto value) {
    return technique.error ? Json(value(*technique.error)) : Json(nullptr);
  };
  json["psnr"] = error([](const ImageError& e) { return e.psnr; });
  json["largest_error"] = error([](const ImageError& e) { return e.largest; });
  const bool known = technique.error.has_value();
  json["ssim"] = known ? Json(technique.perceived.ssim) : Json(nullptr);
  json["hyab"] = known ? Json(technique.perceived.hyab) : Json(nullptr);
  json["flicker"] = or_null(technique.flicker);
  json["differing_pixels"] = error([](const ImageError& e) { return e.differing; });
  return json;
}

// Return the paths of a technique in image_files(). Techniques without any visible difference share the exact
// image.
Json image_of(const CompareReport& report, std::size_t number, const ComparedTechnique& technique) {
  if (!technique.drawn() || report.scenes[number].image.png.empty()) return nullptr;
  return image_path(report, number, technique.images.empty() ? "exact" : technique.name);
}
Json difference_of(const CompareReport& report, std::size_t number, const ComparedTechnique& technique) {
  return technique.images.size() < 2 ? Json(nullptr)
                                     : Json(image_path(report, number, technique.name + "-difference"));
}

// Returns a scene. `number` is its number. The keys "picture" and "difference" are null if there are no such
// files.
Json json_of(const CompareReport& report, std::size_t number, ImageLinks links) {
  const ComparedScene& scene = report.scenes[number];
  const bool has_files = links == ImageLinks::beside;
  Json techniques = Json::array();
  for (const ComparedTechnique& technique : scene.techniques) {
    Json& json = techniques.emplace_back(json_of(technique, scene));
    json["effect"] = report.effect;
    json["picture"] = has_files ? image_of(report, number, technique) : Json(nullptr);
    json["difference"] = has_files ? difference_of(report, number, technique) : Json(nullptr);
  }
  const bool has_image = has_files && !scene.image.png.empty();
  return {{"scene", scene.input},
          {"size", fmt::format("{}x{}", scene.width, scene.height)},
          {"width", scene.width},
          {"height", scene.height},
          {"camera", scene.camera},
          {"triangles", scene.triangles},
          {"objects", scene.objects},
          {"reference", scene.reference},
          {"fragments", scene.exact.fragments},
          {"covered_pixels", scene.exact.covered_pixels},
          {"deepest_pixel", scene.exact.deepest_pixel},
          {"mean_depth", scene.mean_depth()},
          {"coplanar", scene.exact.coplanar},
          {"coplanar_pixels", scene.exact.coplanar_pixels},
          {"c_p", scene.coplanar_share()},
          {"flicker_frames", scene.flicker_frames},
          {"pixels_by_depth", scene.pixels_by_depth},
          {"picture", has_image ? Json(image_path(report, number, "exact")) : Json(nullptr)},
          {"techniques", std::move(techniques)},
          {"notes", scene.notes}};
}

Json json_of(const TechniqueSummary& summary) {
  return {{"name", summary.name},
          {"exact", summary.exact},
          {"scenes", summary.scenes},
          {"failed", summary.scenes - summary.drawn},
          {"equal", summary.equal},
          {"ratio_mean", or_null(summary.time_ratio)},
          {"psnr_worst", or_null(summary.worst_psnr)}};
}

const NamedSweep& named(SweepKind kind) {
  return compare_sweeps()[static_cast<std::size_t>(kind)];
}

Json json_of(const ComparedSweep& sweep) {
  Json points = Json::array();
  for (const SweepPoint& point : sweep.points) {
    Json runs = Json::array();
    for (std::size_t t = 0; t < sweep.techniques.size(); ++t) {
      Json run = {{"name", sweep.techniques[t]}};
      const std::optional<CaptureStats>& stats = point.runs[t];
      append(run,
             json_of_stats(stats.value_or(CaptureStats{}), static_cast<double>(point.width) * point.height),
             stats.has_value());
      runs.push_back(std::move(run));
    }
    points.push_back({{"value", point.value},
                      {"width", point.width},
                      {"height", point.height},
                      {"pool", point.pool},
                      {"techniques", std::move(runs)}});
  }
  return {{"name", named(sweep.kind).name},
          {"parameter", named(sweep.kind).parameter},
          {"scene", sweep.input},
          {"points", std::move(points)}};
}

// ---------------------------------------------------------------------------------------------------- text

std::vector<std::string> cells_of(const ComparedTechnique& technique, const ComparedScene& scene) {
  const char* promise = technique.exact ? "yes" : "no";
  if (!technique.failure.empty()) return {technique.name, promise, "-"};
  const CaptureStats& stats = technique.stats;
  return {technique.name,
          promise,
          format_fixed(stats.milliseconds, 1),
          format_fixed(scene.time_ratio(technique).value_or(NAN), 2),
          std::to_string(stats.geometry_passes),
          std::to_string(stats.rounds),
          format_bytes(stats.bytes),
          format_fixed(static_cast<double>(stats.bytes) / pixels_of(scene), 1),
          format_count(stats.captured),
          format_fixed(stats.captured_share(), 4),
          format_k_range(stats),
          format_count(stats.overflowed),
          format_count(stats.coplanar),
          technique.error ? format_fixed(technique.error->psnr, 1) : "-",
          technique.error ? format_fixed(technique.error->largest, 4) : "-",
          technique.error ? format_fixed(technique.perceived.ssim, 4) : "-",
          technique.error ? format_fixed(technique.perceived.hyab, 3) : "-",
          technique.flicker ? format_fixed(*technique.flicker, 3) : "-"};
}

std::string text_of(const ComparedScene& scene) {
  std::string text =
      fmt::format("{}: {}x{}, {} triangles; {} fragments on {} pixels, at most {}; C_p {}\n", scene.input,
                  scene.width, scene.height, format_count(scene.triangles),
                  format_count(scene.exact.fragments), format_count(scene.exact.covered_pixels),
                  scene.exact.deepest_pixel, format_fixed(scene.coplanar_share(), 3));
  TextTable table({"technique", "exact", "ms", "ratio", "passes", "rounds", "memory", "B/pixel", "captured",
                   "R_h", "k", "overflowed", "coplanar", "PSNR", "largest error", "SSIM", "HyAB", "flicker"});
  std::string failures;
  for (const ComparedTechnique& technique : scene.techniques) {
    table.add_row(cells_of(technique, scene));
    if (!technique.failure.empty()) failures += fmt::format("{}: {}\n", technique.name, technique.failure);
  }
  text += table.to_string() + failures;
  for (const std::string& note : scene.notes) text += fmt::format("note: {}\n", note);
  return text;
}

std::string text_of(const std::vector<TechniqueSummary>& summaries) {
  TextTable table({"over all scenes", "exact", "mean ratio", "worst PSNR", "equal images", "failed"});
  for (const TechniqueSummary& summary : summaries) {
    table.add_row({summary.name, summary.exact ? "yes" : "no",
                   format_fixed(summary.time_ratio.value_or(NAN), 2),
                   format_fixed(summary.worst_psnr.value_or(NAN), 1),
                   fmt::format("{}/{}", summary.equal, summary.scenes),
                   std::to_string(summary.scenes - summary.drawn)});
  }
  return table.to_string();
}

// Returns the milliseconds, or R_h, of every technique and point. Only the page has the other measured
// values.
std::string text_of(const ComparedSweep& sweep) {
  std::vector<std::string> header{fmt::format("{}, ms", named(sweep.kind).name)};
  for (const SweepPoint& point : sweep.points)
    header.push_back(sweep.kind == SweepKind::resolution ? fmt::format("{}x{}", point.width, point.height)
                                                         : fmt::format("{:g}", point.value));
  if (sweep.kind == SweepKind::memory) header.front() = fmt::format("{}, R_h", named(sweep.kind).name);
  TextTable table(header);
  for (std::size_t t = 0; t < sweep.techniques.size(); ++t) {
    std::vector<std::string> row{sweep.techniques[t]};
    for (const SweepPoint& point : sweep.points) {
      const std::optional<CaptureStats>& stats = point.runs[t];
      row.push_back(!stats                            ? "-"
                    : sweep.kind == SweepKind::memory ? format_fixed(stats->captured_share(), 4)
                                                      : format_fixed(stats->milliseconds, 1));
    }
    table.add_row(row);
  }
  return fmt::format("{}: {}\n{}", sweep.input, named(sweep.kind).parameter, table.to_string());
}

}  // namespace

std::string format_k_range(const CaptureStats& stats) {
  if (!stats.k_least || !stats.k_most) return "-";
  if (*stats.k_least == *stats.k_most) return std::to_string(*stats.k_least);
  return fmt::format("{}-{}", *stats.k_least, *stats.k_most);
}

double ComparedScene::coplanar_share() const {
  if (exact.covered_pixels == 0) return 0;
  return static_cast<double>(exact.coplanar_pixels) / static_cast<double>(exact.covered_pixels);
}

double ComparedScene::mean_depth() const {
  if (exact.covered_pixels == 0) return 0;
  return static_cast<double>(exact.fragments) / static_cast<double>(exact.covered_pixels);
}

const ComparedTechnique* ComparedScene::fastest_exact() const {
  const ComparedTechnique* fastest = nullptr;
  for (const ComparedTechnique& technique : techniques) {
    const CaptureStats& stats = technique.stats;
    if (!technique.exact || !technique.failure.empty() || stats.captured != stats.fragments) continue;
    if (fastest == nullptr || stats.milliseconds < fastest->stats.milliseconds) fastest = &technique;
  }
  return fastest;
}

std::span<const NamedSweep> compare_sweeps() {
  static const std::array<NamedSweep, 4> kSweeps{
      {{SweepKind::resolution, "resolution", "pixels of the picture"},
       {SweepKind::coplanarity, "coplanarity", "copies of the scene in one place"},
       {SweepKind::depth, "depth", "copies of the scene behind each other"},
       {SweepKind::memory, "memory", "memory for fragments, as a share of what all of them take"}}};
  return kSweeps;
}

std::string to_text(const CompareReport& report) {
  std::string text = fmt::format("{} on {} ({}), median of {} frames\n", report.effect, report.device.name,
                                 report.device.driver, report.frames > 1 ? report.frames - 1 : 1);
  if (report.device.cpu) text += "This driver runs on the CPU: compare ratios of times, not the times.\n";
  for (const ComparedScene& scene : report.scenes) text += fmt::format("\n{}", text_of(scene));
  if (report.scenes.size() > 1) text += "\n" + text_of(summarize(report));
  for (const ComparedSweep& sweep : report.sweeps) text += fmt::format("\n{}", text_of(sweep));
  return text;
}

std::string to_json(const CompareReport& report, ImageLinks links) {
  Json scenes = Json::array();
  for (std::size_t s = 0; s < report.scenes.size(); ++s) scenes.push_back(json_of(report, s, links));
  Json summary = Json::array();
  for (const TechniqueSummary& technique : summarize(report)) summary.push_back(json_of(technique));
  Json sweeps = Json::array();
  for (const ComparedSweep& sweep : report.sweeps) sweeps.push_back(json_of(sweep));
  Json json = {{"schema", kJsonSchema},           {"version", library_version()},
               {"device", report.device.name},    {"driver", report.device.driver},
               {"cpu_driver", report.device.cpu}, {"effect", report.effect},
               {"surfaces", report.surfaces},     {"k", report.k},
               {"frames", report.frames},         {"memory", report.memory}};
  // The first scene is repeated at the top level, for readers of a single comparison.
  if (!report.scenes.empty()) {
    for (const char* key : {"scene", "size", "width", "height", "techniques"}) json[key] = scenes[0][key];
  }
  json["scenes"] = std::move(scenes);
  json["summary"] = std::move(summary);
  json["sweeps"] = std::move(sweeps);
  json["seconds"] = {{"total", report.seconds_total}};
  json["peak_rss_bytes"] = report.peak_rss_bytes;
  return dump(json);
}

std::vector<TechniqueSummary> summarize(const CompareReport& report) {
  std::vector<Gathered> all;
  for (const ComparedScene& scene : report.scenes)
    for (const ComparedTechnique& technique : scene.techniques)
      gather(technique, scene, entry_of(all, technique));
  std::vector<TechniqueSummary> summaries;
  for (Gathered& one : all) {
    if (one.ratios > 0) one.summary.time_ratio = std::exp(one.log_ratios / one.ratios);
    summaries.push_back(std::move(one.summary));
  }
  return summaries;
}

std::optional<double> ComparedScene::time_ratio(const ComparedTechnique& technique) const {
  const ComparedTechnique* fastest = fastest_exact();
  if (!technique.drawn() || fastest == nullptr || !(fastest->stats.milliseconds > 0)) return std::nullopt;
  return technique.stats.milliseconds / fastest->stats.milliseconds;
}

std::vector<ImageFile> image_files(const CompareReport& report) {
  std::vector<ImageFile> files;
  for (std::size_t s = 0; s < report.scenes.size(); ++s) {
    const ComparedScene& scene = report.scenes[s];
    const auto add = [&](const std::string& what, const std::vector<std::uint8_t>& png) {
      files.push_back({image_path(report, s, what), &png});
    };
    if (!scene.image.png.empty()) add("exact", scene.image.png);
    for (const ReportMap& map : scene.maps) add(map.name, map.png);
    for (const ComparedTechnique& technique : scene.techniques) {
      const std::string& name = technique.name;
      if (!technique.images.empty()) add(name, technique.images[0].png);
      if (technique.images.size() > 1) add(name + "-difference", technique.images[1].png);
      for (const ReportMap& map : technique.maps) add(name + "-" + map.name, map.png);
    }
  }
  return files;
}

}  // namespace pellucid
