// Implements comparison.h: lets capture techniques draw the same scene in turns.
#include "comparison.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "capture_options.h"

namespace pellucid::cli {
namespace {

constexpr const char* kCpu = "cpu";
constexpr const char* kExact = "sb";
// The number of steps of a whole turn of --flicker. Its frames are so near to each other that they could be
// consecutive ones.
constexpr std::uint32_t kFlickerStepsOfATurn = 720;

// Draws a scene by one technique, in turns with others.
class ComparedRun {
 public:
  ComparedRun(const std::string& name, Renderer& renderer, const DrawnScene& drawn,
              const RenderOptions& options, Session& session)
      : renderer_(renderer), drawn_(drawn), options_(options), session_(session) {
    options_.technique = name;
    const auto all = render_techniques();
    options_.peeling.cull =
        options.peeling.cull && std::any_of(all.begin(), all.end(), [&](const TechniqueInfo& t) {
          return t.name == name && t.uses(OptionGroup::culling);
        });
  }

  [[nodiscard]] const std::string& failure() const { return failure_; }
  [[nodiscard]] const CaptureStats& stats() const { return stats_; }

  // Draws the first frame, in which drivers compile. Its pixels are not kept.
  RenderResult draw_first() {
    RenderResult result;
    try {
      options_.budget.maps = true;
      result = draw();
      options_.budget.maps = false;
      stats_ = result.stats;
    } catch (const Error& error) {
      if (error.kind() == ErrorKind::interrupted) throw;
      failure_ = error.what();
    }
    return result;
  }

  void draw_again() {
    if (!failure_.empty()) return;
    options_.statistics = false;
    try {
      frames_.push_back(draw().stats);
    } catch (const Error& error) {
      if (error.kind() == ErrorKind::interrupted) throw;
      failure_ = error.what();
      return;
    }
    take_times(frames_, stats_);
  }

 private:
  RenderResult draw() {
    stop_if_signalled();
    RenderResult result = options_.technique == kCpu
                              ? draw_reference(drawn_.scene, drawn_.camera, options_)
                              : renderer_.draw(drawn_.camera, options_, session_.progress());
    advance_stage(session_.progress(), 1);
    return result;
  }

  Renderer& renderer_;
  const DrawnScene& drawn_;
  RenderOptions options_;
  Session& session_;
  std::string failure_;
  CaptureStats stats_;
  std::vector<CaptureStats> frames_;
};

std::vector<ComparedRun> runs_of(Renderer& renderer, const DrawnScene& drawn,
                                 const ComparisonOptions& options, Session& session) {
  std::vector<ComparedRun> all;
  for (const std::string& name : options.techniques)
    all.emplace_back(name, renderer, drawn, options.draw, session);
  return all;
}

// Draws frames in turns, so that anything that slows the machine for a while slows all techniques.
void take_turns(std::vector<ComparedRun>& all, std::uint32_t frames) {
  for (std::uint32_t frame = 1; frame < frames; ++frame) {
    for (ComparedRun& one : all) one.draw_again();
  }
}

RenderOptions exact_options(const ComparisonOptions& options) {
  RenderOptions exact = options.draw;
  exact.technique = kExact;
  exact.pool.nodes = 0;
  exact.peeling.cull = false;
  return exact;
}

// Draws the exact image, with the fragments of every pixel.
RenderResult draw_exact(Renderer& renderer, const DrawnScene& drawn, const ComparisonOptions& options,
                        Session& session, ComparedScene& compared) {
  RenderOptions exact = exact_options(options);
  exact.keep_fragments = true;
  if (!options.cpu_reference) {
    try {
      compared.reference = kExact;
      return renderer.draw(drawn.camera, exact, session.progress());
    } catch (const Error& error) {
      if (error.kind() == ErrorKind::interrupted) throw;
      compared.notes.push_back(fmt::format("the exact image is that of the CPU: {}", error.what()));
    }
  }
  compared.reference = kCpu;
  return draw_reference(drawn.scene, drawn.camera, exact);
}

std::vector<std::uint64_t> pixels_by_depth(const CapturedFragments& fragments, std::uint64_t deepest) {
  std::vector<std::uint64_t> pixels(deepest + 1);
  for (std::size_t p = 0; p + 1 < fragments.offsets.size(); ++p)
    ++pixels[fragments.offsets[p + 1] - fragments.offsets[p]];
  return pixels;
}

// Measures how much more the image of each technique changes than the exact one while the camera turns.
void measure_flicker(Renderer& renderer, const DrawnScene& drawn, const ComparisonOptions& options,
                     Session& session, ComparedScene& compared) {
  const RenderOptions exact = exact_options(options);
  compared.flicker_frames = static_cast<std::uint32_t>(drawn.turn.size());
  begin_stage(session.progress(), "turning", drawn.turn.size() * options.techniques.size());
  std::vector<Flicker> flicker(options.techniques.size());
  DrawnScene turned = drawn;
  for (const Camera& camera : drawn.turn) {
    turned.camera = camera;
    const RenderResult expected = renderer.draw(camera, exact, session.progress());
    std::vector<ComparedRun> all = runs_of(renderer, turned, options, session);
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (!compared.techniques[i].failure.empty()) continue;
      const RenderResult result = all[i].draw_first();
      if (!all[i].failure().empty()) {
        compared.notes.push_back(options.techniques[i] + ", turning: " + all[i].failure());
        flicker[i] = {};
      } else {
        flicker[i].add(expected.pixels, result.pixels, expected.stats.seen_pixels);
      }
    }
  }
  for (std::size_t i = 0; i < flicker.size(); ++i) compared.techniques[i].flicker = flicker[i].mean();
}

// Does the same, but turns an error into a note, because the rest of the report is still valid.
void try_flicker(Renderer& renderer, const DrawnScene& drawn, const ComparisonOptions& options,
                 Session& session, ComparedScene& compared) {
  try {
    measure_flicker(renderer, drawn, options, session, compared);
  } catch (const Error& error) {
    if (error.kind() == ErrorKind::interrupted) throw;
    compared.notes.push_back(fmt::format("flicker was not measured: {}", error.what()));
  }
}

// Returns the image of a technique and its difference from the exact one, if that is visible.
std::vector<ReportImage> images_of(const std::string& name, const Image& exact, const RenderResult& drawn,
                                   const ImageError& error) {
  if (error.differing == 0) return {};
  const Image image = to_image(drawn);
  return {{name, encode_png(image)},
          {fmt::format("difference: {} of {} pixels", error.differing, drawn.pixels.size()),
           encode_png(difference_image(exact, image))}};
}

bool has_colors(const Image& image, std::size_t least) {
  std::set<std::array<std::uint8_t, 3>> colors;
  for (std::size_t i = 0; i + 2 < image.rgb.size() && colors.size() < least; i += 3)
    colors.insert({image.rgb[i], image.rgb[i + 1], image.rgb[i + 2]});
  return colors.size() >= least;
}

// Returns the maps that show something: those with at least `least_colors` colours.
std::vector<ReportMap> report_maps(const std::vector<NamedMap>& maps, std::size_t least_colors) {
  std::vector<ReportMap> all;
  for (const NamedMap& map : maps) {
    if (has_colors(map.image, least_colors))
      all.push_back({map.name, map.words, map.unit, map.most, encode_png(map.image)});
  }
  return all;
}

// Makes copies of all triangles, with moved corners. Copy 0 is the scene itself.
template <class Move>
RenderScene copied(const RenderScene& scene, std::uint32_t copies, const Move& move) {
  RenderScene out = scene;
  const auto vertices = static_cast<std::uint32_t>(scene.positions.size());
  for (std::uint32_t copy = 1; copy < copies; ++copy) {
    for (const Vec3f& position : scene.positions) out.positions.push_back(move(position, copy));
    out.normals.insert(out.normals.end(), scene.normals.begin(), scene.normals.end());
    for (const Triangle& t : scene.triangles) {
      const std::uint32_t first = copy * vertices;
      out.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
    }
    out.objects.insert(out.objects.end(), scene.objects.begin(), scene.objects.end());
  }
  return out;
}

DrawnScene in_one_place(const DrawnScene& drawn, std::uint32_t copies) {
  return {drawn.input,
          copied(drawn.scene, copies, [](const Vec3f& p, std::uint32_t) { return p; }),
          drawn.camera,
          {}};
}

// Moves the copies along the lines of sight, so that every copy covers the same pixels.
DrawnScene behind_each_other(const DrawnScene& drawn, std::uint32_t copies) {
  constexpr double kDepth = 0.25;  // of the scene's distance, for all copies together
  const Camera& camera = drawn.camera;
  const double step = kDepth / copies;
  const auto move = [&](const Vec3f& p, std::uint32_t copy) {
    const Vec3d position = to_double(p);
    const Vec3d along = camera.perspective
                            ? (position - camera.eye) * (step * copy)
                            : camera.forward * ((camera.far_plane - camera.near_plane) * step * copy);
    return to_float(position + along);
  };
  DrawnScene out{drawn.input, copied(drawn.scene, copies, move), camera, {}};
  out.camera.far_plane *= 1 + kDepth;
  return out;
}

DrawnScene at_scale(const DrawnScene& drawn, double area) {
  DrawnScene out = drawn;
  const auto scaled = [&](std::uint32_t side) {
    return std::max(1U, static_cast<std::uint32_t>(std::lround(side * std::sqrt(area))));
  };
  out.camera.width = scaled(drawn.camera.width);
  out.camera.height = scaled(drawn.camera.height);
  return out;
}

std::vector<double> values_of(SweepKind kind) {
  if (kind == SweepKind::resolution) return {0.0625, 0.25, 0.5, 1};
  if (kind == SweepKind::memory) return {0.125, 0.25, 0.5, 0.75, 1};
  return {1, 2, 4, 8};
}

DrawnScene varied(const DrawnScene& drawn, SweepKind kind, double value) {
  const auto copies = static_cast<std::uint32_t>(value);
  switch (kind) {
    case SweepKind::resolution:
      return at_scale(drawn, value);
    case SweepKind::coplanarity:
      return in_one_place(drawn, copies);
    case SweepKind::depth:
      return behind_each_other(drawn, copies);
    case SweepKind::memory:
      break;
  }
  return drawn;
}

// Counts the fragments of the scene by a technique without a pool.
std::uint64_t count_fragments(Renderer& renderer, const DrawnScene& drawn, const ComparisonOptions& options,
                              Session& session) {
  RenderOptions exact = options.draw;
  exact.technique = kExact;
  exact.pool.nodes = 0;
  return renderer.draw(drawn.camera, exact, session.progress()).stats.fragments;
}

}  // namespace

DrawnScene open_scene(const Model& model, const CaptureJob& job) {
  const Scene scene = make_scene(model);
  std::vector<std::string> notes;
  DrawnScene drawn{model.path,
                   make_render_scene(model, scene, job.surfaces, job.look, &notes),
                   camera_from(job.camera_text, job.lens, model, scene, job.width, job.height),
                   {}};
  drawn.notes = std::move(notes);
  std::vector<Shot> shots = orbit(job.camera_text, kFlickerStepsOfATurn);
  shots.resize(std::min<std::size_t>(shots.size(), job.flicker));
  for (const Shot& shot : shots)
    drawn.turn.push_back(camera_from(shot.camera, job.lens, model, scene, job.width, job.height));
  if (!job.ignore_orders) drawn.scene.draw_order = drawing_order(scene, drawn.camera, {});
  return drawn;
}

ComparedScene compare_techniques(Renderer& renderer, const DrawnScene& drawn,
                                 const ComparisonOptions& options, Session& session) {
  ComparedScene compared;
  compared.input = drawn.input;
  compared.width = drawn.camera.width;
  compared.height = drawn.camera.height;
  compared.triangles = drawn.scene.triangles.size();
  compared.objects = drawn.scene.surfaces.size();
  session.set_subject(drawn.input);
  begin_stage(session.progress(), "drawing", options.techniques.size() * options.frames);
  renderer.load(drawn.scene);
  RenderResult exact = draw_exact(renderer, drawn, options, session, compared);
  compared.exact = exact.stats;
  compared.pixels_by_depth = pixels_by_depth(exact.fragments, exact.stats.deepest_pixel);
  compared.maps = report_maps(fragment_heat_maps(exact, options.draw.samples), 2);
  exact.fragments = {};
  const Image exact_image = to_image(exact);
  compared.image = {fmt::format("exact, by {}", compared.reference), encode_png(exact_image)};

  std::vector<ComparedRun> all = runs_of(renderer, drawn, options, session);
  for (ComparedRun& one : all) {
    const RenderResult result = one.draw_first();
    const std::string& name = options.techniques[compared.techniques.size()];
    const TechniqueInfo info = technique_info(name, "--techniques", "");
    ComparedTechnique& row = compared.techniques.emplace_back();
    row.name = name;
    row.title = info.title;
    row.exact = info.exact;
    if (!one.failure().empty()) continue;
    row.error = image_error(exact.pixels, result.pixels, exact.stats.seen_pixels);
    row.perceived =
        perceived_error(exact.pixels, result.pixels, result.width, result.height, exact.stats.seen_pixels);
    row.images = images_of(name, exact_image, result, *row.error);
    // A map with a single value, beside the white of no fragments, is not worth an image.
    row.maps = report_maps(budget_heat_maps(result, options.draw.samples), 3);
  }
  take_turns(all, options.frames);
  for (std::size_t i = 0; i < all.size(); ++i) {
    compared.techniques[i].stats = all[i].stats();
    compared.techniques[i].failure = all[i].failure();
    const CaptureStats& stats = all[i].stats();
    if (stats.chosen.empty()) continue;
    // With a memory budget, a technique promises only what fits.
    compared.techniques[i].exact = stats.captured == stats.fragments;
    compared.notes.push_back(
        fmt::format("{} took {}: {}", options.techniques[i], stats.chosen, stats.reason));
  }
  if (!drawn.turn.empty()) try_flicker(renderer, drawn, options, session, compared);
  return compared;
}

ComparedSweep sweep(Renderer& renderer, const DrawnScene& drawn, SweepKind kind,
                    const ComparisonOptions& options, Session& session) {
  ComparedSweep result{kind, drawn.input, options.techniques, {}};
  const std::vector<double> values = values_of(kind);
  session.set_subject(compare_sweeps()[static_cast<std::size_t>(kind)].name);
  begin_stage(session.progress(), "drawing", values.size() * options.techniques.size() * options.frames);
  for (const double value : values) {
    const DrawnScene scene = varied(drawn, kind, value);
    ComparisonOptions at = options;
    renderer.load(scene.scene);
    SweepPoint point{value, scene.camera.width, scene.camera.height, 0, {}};
    if (kind == SweepKind::memory) {
      const double fragments = static_cast<double>(count_fragments(renderer, scene, options, session));
      point.pool = std::max<std::uint64_t>(1, static_cast<std::uint64_t>(std::llround(value * fragments)));
      at.draw.pool.nodes = point.pool;
      // The bytes that `sb` takes for that pool.
      at.draw.budget.bytes = 12 * point.pool + 8 * std::uint64_t{scene.camera.width} * scene.camera.height *
                                                   options.draw.samples;
    }
    std::vector<ComparedRun> all = runs_of(renderer, scene, at, session);
    for (ComparedRun& one : all) one.draw_first();
    take_turns(all, options.frames);
    for (const ComparedRun& one : all)
      point.runs.push_back(one.failure().empty() ? std::optional(one.stats()) : std::nullopt);
    result.points.push_back(std::move(point));
  }
  return result;
}

}  // namespace pellucid::cli
