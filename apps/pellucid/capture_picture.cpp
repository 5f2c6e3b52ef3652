// A captured picture: see capture_picture.h.
#include "capture_picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

#include "file_camera.h"
#include "pellucid/report.h"
#include "pose.h"
#include "terminal_progress.h"

namespace pellucid::cli {
namespace {

constexpr const char* kReference = "cpu";

const NamedEffect& named(Effect effect) {
  return render_effects()[static_cast<std::size_t>(effect)];
}

std::string bytes_text(std::uint64_t bytes) {
  return fmt::format("{:.1f} MB", static_cast<double>(bytes) / 1e6);
}

void print_result(const CapturePicture& picture, const std::string& device, const CaptureStats& stats,
                  const Session& session) {
  session.print(fmt::format(
      "{}: {}x{}, {} by {} on {}\n{} fragments on {} {}, at most {}; {} coplanar; captured {}{}\n"
      "{} geometry passes, {}, {:.1f} ms\n",
      picture.output, picture.width, picture.height, named(picture.options.effect).name,
      picture.options.technique, device, format_count(stats.fragments), format_count(stats.covered_pixels),
      picture.options.samples > 1 ? "samples" : "pixels", stats.deepest_pixel, format_count(stats.coplanar),
      format_percent(stats.captured_share()),
      stats.overflowed > 0 ? fmt::format(", {} found no place", format_count(stats.overflowed)) : "",
      stats.geometry_passes, bytes_text(stats.bytes), stats.milliseconds));
}

nlohmann::ordered_json to_json(const CapturePicture& picture, const std::string& device,
                               const CaptureStats& stats, std::size_t triangles, double seconds) {
  const double pixels = static_cast<double>(picture.width) * picture.height;
  return {{"schema", 1},
          {"version", library_version()},
          {"input", picture.input},
          {"output", picture.output},
          {"technique", picture.options.technique},
          {"effect", named(picture.options.effect).name},
          {"device", device},
          {"width", picture.width},
          {"height", picture.height},
          {"triangles", triangles},
          {"fragments", stats.fragments},
          {"captured", stats.captured},
          {"r_h", stats.captured_share()},
          {"overflowed", stats.overflowed},
          {"coplanar", stats.coplanar},
          {"coplanar_pixels", stats.coplanar_pixels},
          {"covered_pixels", stats.covered_pixels},
          {"deepest_pixel", stats.deepest_pixel},
          {"rounds", stats.rounds},
          {"passes", stats.geometry_passes},
          {"fullscreen_passes", stats.fullscreen_passes},
          {"bytes", stats.bytes},
          {"bytes_per_pixel", static_cast<double>(stats.bytes) / pixels},
          {"milliseconds", stats.milliseconds},
          {"resolve_milliseconds", stats.resolve_milliseconds},
          {"drawn_share", stats.drawn_share},
          {"seconds", {{"total", seconds}}},
          {"peak_rss_bytes", peak_rss_bytes()}};
}

bool any_deforms(const Model& model) {
  return std::any_of(model.primitives.begin(), model.primitives.end(),
                     [](const Primitive& p) { return p.deforms; });
}

// Times of more frames, in which nothing is counted: their medians.
void time_more_frames(const CapturePicture& picture, const Camera& camera, Renderer& renderer,
                      const Session& session, CaptureStats& stats) {
  RenderOptions options = picture.options;
  options.statistics = false;
  std::vector<double> all;
  std::vector<double> resolve;
  for (std::uint32_t frame = 1; frame < picture.frames; ++frame) {
    const CaptureStats times = renderer.draw(camera, options, session.progress()).stats;
    all.push_back(times.milliseconds);
    resolve.push_back(times.resolve_milliseconds);
    stop_if_signalled();
  }
  const auto median = [](std::vector<double>& values) {
    std::sort(values.begin(), values.end());
    return values[values.size() / 2];
  };
  stats.milliseconds = median(all);
  stats.resolve_milliseconds = median(resolve);
}

}  // namespace

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

void render_capture(const CapturePicture& picture, Session& session) {
  const Stopwatch watch;
  const bool reference = picture.options.technique == kReference;
  // A device that is not there is told before a large file is read.
  std::optional<Renderer> renderer;
  if (!reference) renderer.emplace(picture.device);
  if (!is_file_camera(picture.camera_text)) parse_camera(picture.camera_text);
  const Model model = read_model(picture.input);
  Scene scene = make_scene(model);
  if (!picture.animation.empty() || any_deforms(model)) {
    pose_scene(model, picture.animation, picture.time, scene);
  }
  std::vector<std::string> notes;
  RenderScene drawn = make_render_scene(model, scene, picture.surfaces, picture.look, &notes);
  for (const std::string& note : notes) session.note(note);
  stop_if_signalled();
  const Camera camera = camera_from(picture.camera_text, model, scene, picture.width, picture.height);
  if (!picture.ignore_orders && picture.animation.empty()) drawn.sequence = drawing_sequence(scene, camera);
  RenderResult result;
  if (reference) {
    result = draw_reference(drawn, camera, picture.options);
  } else {
    renderer->load(drawn);
    result = renderer->draw(camera, picture.options, session.progress());
    if (picture.frames > 1) time_more_frames(picture, camera, *renderer, session, result.stats);
    for (const std::string& message : renderer->validation_messages()) session.note(message);
  }
  stop_if_signalled();
  write_png(to_image(result), picture.output);
  const std::string device = reference ? std::string(kReference) : renderer->info().name;
  print_result(picture, device, result.stats, session);
  session.write_json(to_json(picture, device, result.stats, drawn.triangles.size(), watch.seconds())
                         .dump(2, ' ', false, nlohmann::json::error_handler_t::replace) +
                     "\n");
}

}  // namespace pellucid::cli
