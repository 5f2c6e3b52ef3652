// Implements capture_job.h: draws images by a capture technique.
#include "capture_job.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

#include "budget_options.h"
#include "capture_options.h"
#include "deep_pixels.h"
#include "pellucid/compare_report.h"
#include "pellucid/report.h"

namespace pellucid::cli {
namespace {

constexpr const char* kReference = "cpu";

const NamedEffect& named(Effect effect) {
  return render_effects()[static_cast<std::size_t>(effect)];
}

std::string bytes_text(std::uint64_t bytes) {
  return fmt::format("{:.1f} MB", static_cast<double>(bytes) / 1e6);
}

// One of the requested images.
struct Taken {
  std::string output, camera;
  double time = 0;
  CaptureStats stats;
  nlohmann::ordered_json pixels;  // for --pixel
};

void print_result(const CaptureJob& job, const std::string& device, const Taken& taken,
                  const Session& session) {
  const CaptureStats& stats = taken.stats;
  session.print(fmt::format(
      "{}: {}x{}, {} by {} on {}\n{} fragments on {} {}, at most {}; {} coplanar; captured {}{}\n"
      "{}{} geometry passes, {}, {:.1f} ms\n",
      taken.output, job.width, job.height, named(job.options.effect).name, job.options.technique, device,
      format_count(stats.fragments), format_count(stats.covered_pixels),
      job.options.samples > 1 ? "samples" : "pixels", stats.deepest_pixel, format_count(stats.coplanar),
      format_percent(stats.captured_share()),
      stats.overflowed > 0 ? fmt::format(", {} found no place", format_count(stats.overflowed)) : "",
      stats.rounds > 1 ? fmt::format("{} rounds, ", stats.rounds)
      : stats.k_least  ? fmt::format("k {}, ", format_k_range(stats))
                       : "",
      stats.geometry_passes, bytes_text(stats.bytes), stats.milliseconds));
  if (!stats.chosen.empty()) session.print(fmt::format("{}: {}\n", stats.chosen, stats.reason));
}

template <class Value>
nlohmann::ordered_json or_null(const std::optional<Value>& value) {
  return value ? nlohmann::ordered_json(*value) : nlohmann::ordered_json(nullptr);
}

nlohmann::ordered_json text_or_null(const std::string& text) {
  return text.empty() ? nlohmann::ordered_json(nullptr) : nlohmann::ordered_json(text);
}

nlohmann::ordered_json sync_json(Sync chosen) {
  if (chosen == Sync::automatic) return nullptr;
  const auto names = sync_names();
  return std::find_if(names.begin(), names.end(), [&](const auto& n) { return n.second == chosen; })->first;
}

nlohmann::ordered_json to_json(const CaptureStats& stats, double pixels) {
  return {{"fragments", stats.fragments},
          {"captured", stats.captured},
          {"r_h", stats.captured_share()},
          {"overflowed", stats.overflowed},
          {"pool_exceeded", stats.pool_exceeded},
          {"repaired_pixels", stats.repaired_pixels},
          {"misordered_pixels", stats.misordered_pixels},
          {"coplanar", stats.coplanar},
          {"coplanar_pixels", stats.coplanar_pixels},
          {"k_least", or_null(stats.k_least)},
          {"k_most", or_null(stats.k_most)},
          {"k_mean", or_null(stats.k_mean())},
          {"covered_pixels", stats.covered_pixels},
          {"deepest_pixel", stats.deepest_pixel},
          {"sync", sync_json(stats.sync)},
          {"chosen", text_or_null(stats.chosen)},
          {"reason", text_or_null(stats.reason)},
          {"rounds", stats.rounds},
          {"passes", stats.geometry_passes},
          {"fullscreen_passes", stats.fullscreen_passes},
          {"bytes", stats.bytes},
          {"bytes_per_pixel", static_cast<double>(stats.bytes) / pixels},
          {"milliseconds", stats.milliseconds},
          {"resolve_milliseconds", stats.resolve_milliseconds},
          {"drawn_share", stats.drawn_share}};
}

// Returns the JSON. For one image the numbers are at the top level, for several they are in a list.
nlohmann::ordered_json to_json(const CaptureJob& job, const std::string& device,
                               const std::vector<Taken>& taken, std::size_t triangles, double seconds) {
  const double pixels = static_cast<double>(job.width) * job.height;
  nlohmann::ordered_json json = {{"schema", 1},
                                 {"version", library_version()},
                                 {"input", job.input},
                                 {"output", job.output},
                                 {"technique", job.options.technique},
                                 {"effect", named(job.options.effect).name},
                                 {"device", device},
                                 {"width", job.width},
                                 {"height", job.height},
                                 {"triangles", triangles}};
  if (job.shots.empty()) {
    json.update(to_json(taken.front().stats, pixels));
    if (!job.pixels.empty()) json["deep_pixels"] = taken.front().pixels;
  } else {
    for (const Taken& one : taken) {
      nlohmann::ordered_json entry = {{"output", one.output}, {"camera", one.camera}, {"time", one.time}};
      entry.update(to_json(one.stats, pixels));
      if (!job.pixels.empty()) entry["deep_pixels"] = one.pixels;
      json["pictures"].push_back(std::move(entry));
    }
  }
  json["seconds"] = {{"total", seconds}};
  json["peak_rss_bytes"] = peak_rss_bytes();
  return json;
}

// Draws more frames, in which nothing is counted, and sets the times to their medians.
void time_more_frames(std::uint32_t frames, RenderOptions options, const Camera& camera, Renderer& renderer,
                      const Session& session, CaptureStats& stats) {
  options.statistics = false;
  options.budget.maps = false;
  std::vector<CaptureStats> all;
  for (std::uint32_t frame = 1; frame < frames; ++frame) {
    all.push_back(renderer.draw(camera, options, session.progress()).stats);
    stop_if_signalled();
  }
  take_times(all, stats);
}

}  // namespace

void take_times(std::vector<CaptureStats> frames, CaptureStats& stats) {
  const auto median_by = [&](double CaptureStats::*time) -> const CaptureStats& {
    const auto middle = frames.begin() + static_cast<std::ptrdiff_t>(frames.size() / 2);
    std::nth_element(frames.begin(), middle, frames.end(),
                     [&](const CaptureStats& a, const CaptureStats& b) { return a.*time < b.*time; });
    return *middle;
  };
  stats.resolve_milliseconds = median_by(&CaptureStats::resolve_milliseconds).resolve_milliseconds;
  const CaptureStats& median = median_by(&CaptureStats::milliseconds);
  stats.milliseconds = median.milliseconds;
  // For `auto`: the technique that it chose in these frames, and what that takes.
  if (median.chosen.empty()) return;
  stats.chosen = median.chosen;
  stats.reason = median.reason;
  stats.sync = median.sync;
  stats.bytes = median.bytes;
  stats.rounds = median.rounds;
  stats.geometry_passes = median.geometry_passes;
  stats.fullscreen_passes = median.fullscreen_passes;
  stats.repaired_pixels = median.repaired_pixels;
}

Image to_image(const RenderResult& result) {
  Image image{result.width, result.height, {}};
  image.rgb.reserve(3 * result.pixels.size());
  const auto byte = [](float linear) {
    return static_cast<std::uint8_t>(std::lround(255 * srgb_from_linear(double{linear})));
  };
  for (const Vec3f& p : result.pixels) {
    image.rgb.push_back(byte(p.x));
    image.rgb.push_back(byte(p.y));
    image.rgb.push_back(byte(p.z));
  }
  return image;
}

namespace {

std::vector<Shot> shots_of(const CaptureJob& job) {
  if (job.shots.empty()) return {{job.camera_text, job.time}};
  return job.shots;
}

// The scene at one time, and what is made of it for drawing.
class Stage {
 public:
  Stage(const CaptureJob& job, const Model& model)
      : job_(job), model_(model), rest_(make_scene(model)), options_(job.options) {
    options_.budget.maps = !job.maps.empty();
    options_.budget.importance.image = read_importance(job.importance_image);
  }

  // Poses the scene. Throws as pose_scene() and make_render_scene() do.
  void set(double time) {
    if (time_ && (*time_ == time || job_.animation.empty())) return;
    time_ = time;
    scene_ = rest_;
    pose_.time = time;
    if (!job_.animation.empty()) pose_.animation = pose_scene(model_, job_.animation, time, scene_);
    notes_.clear();
    drawn_ = make_render_scene(model_, scene_, job_.surfaces, job_.look, &notes_);
    loaded_ = false;
  }

  [[nodiscard]] const Scene& scene() const { return scene_; }
  [[nodiscard]] const std::vector<std::string>& notes() const { return notes_; }

  // Draws on the device, or on the CPU if `renderer` is null.
  RenderResult draw(const Camera& camera, Renderer* renderer, const Session& session) {
    if (!job_.ignore_orders) {
      std::vector<std::uint32_t> sequence = drawing_order(scene_, camera, pose_);
      loaded_ = loaded_ && sequence == drawn_.draw_order;
      drawn_.draw_order = std::move(sequence);
    }
    if (renderer == nullptr) return draw_reference(drawn_, camera, options_);
    if (!loaded_) renderer->load(drawn_);
    loaded_ = true;
    RenderResult result = renderer->draw(camera, options_, session.progress());
    if (job_.frames > 1) time_more_frames(job_.frames, options_, camera, *renderer, session, result.stats);
    return result;
  }

  // Draws the same with all fragments, including opaque and hidden ones.
  DeepImage draw_deep(const Camera& camera, Renderer* renderer, const Session& session) {
    const RenderOptions options = deep_options(options_);
    return make_deep_image(renderer == nullptr ? draw_reference(drawn_, camera, options)
                                               : renderer->draw(camera, options, session.progress()),
                           drawn_, camera);
  }

 private:
  const CaptureJob& job_;
  const Model& model_;
  Scene rest_, scene_;
  RenderScene drawn_;
  std::vector<std::string> notes_;
  std::optional<double> time_;
  ScenePose pose_;
  RenderOptions options_;
  bool loaded_ = false;
};

}  // namespace

void render_capture(const CaptureJob& job, Session& session) {
  const Stopwatch watch;
  const bool reference = job.options.technique == kReference;
  if (wants_fragments(job)) check_deep(job);
  // A missing device is reported before a large file is read.
  std::optional<Renderer> renderer;
  if (!reference) renderer.emplace(job.device);
  const std::vector<Shot> shots = shots_of(job);
  for (const Shot& shot : shots)
    if (!is_file_camera(shot.camera)) parse_camera(shot.camera);
  const Model model = open_model(job.input, session);
  const std::string device = reference ? std::string(kReference) : renderer->info().name;
  Stage stage(job, model);
  std::vector<Taken> taken;
  for (const Shot& shot : shots) {
    const double time = shot.time.value_or(job.time);
    stage.set(time);
    if (taken.empty())
      for (const std::string& note : stage.notes()) session.note(note);
    stop_if_signalled();
    const Camera camera = camera_from(shot.camera, job.lens, model, stage.scene(), job.width, job.height);
    const RenderResult result = stage.draw(camera, renderer ? &*renderer : nullptr, session);
    stop_if_signalled();
    const auto numbered = [&, number = taken.size() + 1](const std::string& name) {
      return job.shots.empty() ? name : numbered_output(name, number, shots.size());
    };
    const std::string output = numbered(job.output);
    write_png(to_image(result), output);
    if (!job.maps.empty()) write_maps(result, job.options.samples, numbered(job.maps));
    taken.push_back({output, shot.camera, time, result.stats, {}});
    print_result(job, device, taken.back(), session);
    if (wants_fragments(job)) {
      const DeepImage deep = stage.draw_deep(camera, renderer ? &*renderer : nullptr, session);
      if (!job.deep.empty()) write_deep_exr(deep, numbered(job.deep));
      session.print(pixel_tables(job, deep));
      taken.back().pixels = pixels_json(job, deep);
    }
  }
  if (renderer)
    for (const std::string& message : renderer->validation_messages()) session.note(message);
  session.write_json(to_json(job, device, taken, stage.scene().mesh.triangles.size(), watch.seconds())
                         .dump(2, ' ', false, nlohmann::json::error_handler_t::replace) +
                     "\n");
}

}  // namespace pellucid::cli
