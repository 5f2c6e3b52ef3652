// Implements `pellucid overdraw`, which makes a few triangle orders that reduce overdraw, for static and
// animated models.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <sstream>

#include "choice.h"
#include "cleaned.h"
#include "order_options.h"
#include "pellucid/asset.h"
#include "pellucid/metric.h"
#include "pellucid/overdraw_report.h"
#include "pellucid/overdraw_subject.h"
#include "pellucid/report.h"
#include "pellucid/subdivide.h"
#include "selection.h"
#include "session.h"

namespace pellucid::cli {
namespace {

struct OverdrawCommandOptions {
  const CLI::App* command = nullptr;  // knows which options were given
  std::string input, output;
  std::string report, chart, heatmaps;  // files to write
  OverdrawOptions orders;
  std::uint32_t views = 0;  // 0: the default, which depends on whether anything moves
  bool joint = false, per_animation = false;
  SubjectOptions subject;
  std::string baselines = "all";
  std::uint32_t check_views = 300;
  std::uint64_t max_images = 3000;
  WriteOptions write;
};

std::vector<std::string> baseline_list(const std::string& text) {
  if (text == "none") return {};
  if (text == "all") return {"original", "meshopt", "per-frame", "single", "paper"};
  std::vector<std::string> names;
  std::istringstream stream(text);
  for (std::string name; std::getline(stream, name, ',');) names.push_back(name);
  return names;
}

std::uint32_t level_of(std::uint32_t views) {
  for (std::uint32_t level = 0; level <= 3; ++level) {
    if (views == 10U * (1U << (2 * level)) + 2) return level;
  }
  throw Error(ErrorKind::bad_argument, fmt::format("--views: {} is not one of 12, 42, 162, 642", views));
}

// Sets the defaults that depend on whether anything moves.
void settle(OverdrawCommandOptions& options, const PosedSubject& posed) {
  const bool is_static = posed.clips.empty();
  OverdrawOptions& orders = options.orders;
  if (is_static && options.command->count("--buffers") == 0) orders.buffers = 1;
  // A static model has time for more viewpoints, and a single order for all directions needs them.
  orders.view_level = options.views > 0 ? level_of(options.views) : is_static ? 3 : 2;
  if (is_static && orders.method == OverdrawMethod::refined && options.command->count("--lambda") == 0 &&
      !orders.acmr) {
    // The result can then replace that of meshopt_optimizeOverdraw() at its usual threshold.
    constexpr float kUsualThreshold = 1.05F;
    orders.acmr = acmr_of(posed.subject, {meshopt_overdraw_order(posed.subject, posed.rest, kUsualThreshold)},
                          orders.cache_size);
  }
}

// The orders that are measured: ours first, then the file's own order, then the other baselines.
struct Compared {
  std::vector<MeasuredOverdrawMethod> methods;
};

Compared make_compared(const OverdrawCommandOptions& options, const PosedSubject& posed,
                       const OverdrawSets& sets) {
  Compared compared;
  const std::string own = options.orders.method == OverdrawMethod::paper ? "paper" : "refined";
  compared.methods.push_back(method_of_sets(own, posed.subject, sets, options.orders.cache_size));
  OverdrawBaselineOptions baselines;
  baselines.names = {"input"};
  for (const std::string& name : baseline_list(options.baselines)) {
    if (name != own && name != "input") baselines.names.push_back(name);
  }
  baselines.orders = options.orders;
  baselines.joint = !options.per_animation;
  baselines.acmr = compared.methods.front().acmr;
  baselines.rest = posed.rest;
  for (MeasuredOverdrawMethod& method : make_overdraw_baselines(posed.subject, posed.frames, baselines))
    compared.methods.push_back(std::move(method));
  return compared;
}

PosedOverdrawOptions measurement_of(const OverdrawCommandOptions& options, Session& session) {
  PosedOverdrawOptions measurement;
  measurement.viewpoints = options.check_views;
  measurement.min_distance = options.orders.min_distance;
  measurement.max_distance = options.orders.max_distance;
  measurement.size = options.orders.size;
  measurement.most_images = options.max_images;
  measurement.progress = session.progress();
  return measurement;
}

std::vector<OverdrawRow> measure_all(const Model& model, const OverdrawCommandOptions& options,
                                     const PosedSubject& posed, const Compared& compared, Session& session) {
  std::vector<PosedDrawingMethod> drawings;
  for (const MeasuredOverdrawMethod& method : compared.methods) drawings.push_back(method.drawing);
  const PosedOverdrawOptions measurement = measurement_of(options, session);
  const std::vector<OverdrawQuality> at_keys = measure_posed_overdraw(posed.subject, drawings, measurement);

  std::vector<OverdrawQuality> between;
  if (!posed.clips.empty()) {
    const PosesBetween poses = poses_between(model, posed, options.subject);
    for (PosedDrawingMethod& drawing : drawings) {
      drawing.ranks = [inner = drawing.ranks, &poses](std::uint32_t frame, const Viewpoint& viewpoint) {
        return inner(poses.nearest[frame], viewpoint);
      };
    }
    if (!poses.nearest.empty()) between = measure_posed_overdraw(poses.subject, drawings, measurement);
  }
  std::vector<OverdrawRow> rows;
  for (std::size_t i = 0; i < compared.methods.size(); ++i) {
    const MeasuredOverdrawMethod& method = compared.methods[i];
    rows.push_back({method.name, method.buffers, method.acmr, at_keys[i], std::nullopt});
    if (!between.empty()) rows.back().between = between[i];
  }
  return rows;
}

// Returns the order of the file as an order set, which is written if nothing better was found.
OverdrawSets input_as_orders(const PosedSubject& posed, const OverdrawOptions& options) {
  OverdrawSets sets;
  sets.view_level = options.view_level;
  OverdrawOrders own;
  const OverdrawSubject& subject = posed.subject;
  for (std::uint32_t triangle = 0; triangle < subject.triangles.size(); ++triangle)
    own.sequence.push_back(triangle);
  own.orders.emplace_back();
  for (std::uint32_t part = 0; part < subject.parts.size(); ++part) {
    own.patch_offsets.push_back(subject.parts[part]);
    own.patch_parts.push_back(part);
    own.orders.front().push_back(part);
  }
  own.patch_offsets.push_back(static_cast<std::uint32_t>(subject.triangles.size()));
  own.spheres = pose_spheres(subject);
  const std::size_t cells = 10 * (std::size_t{1} << (2 * options.view_level)) + 2;
  own.cell_orders.assign(cells * subject.frames.size(), 0);
  sets.sets.push_back(std::move(own));
  for (std::uint32_t frame = 0; frame < posed.frames.size(); ++frame) {
    sets.set_of.push_back(0);
    sets.frame_in_set.push_back(frame);
  }
  return sets;
}

// Returns heat maps of all methods at some key frames, seen obliquely from above.
std::vector<std::vector<HeatMap>> heat_maps(const PosedSubject& posed, const Compared& compared,
                                            std::uint32_t size) {
  constexpr std::size_t kFrames = 6;
  constexpr double kAzimuth = 35 * std::numbers::pi / 180;
  constexpr double kElevation = 15 * std::numbers::pi / 180;
  const Viewpoint viewpoint{{std::cos(kElevation) * std::sin(kAzimuth), std::sin(kElevation),
                             std::cos(kElevation) * std::cos(kAzimuth)},
                            2.2};
  const std::size_t count = std::min(kFrames, posed.frames.size());
  std::vector<std::vector<HeatMap>> sheet;
  for (const MeasuredOverdrawMethod& method : compared.methods) {
    sheet.emplace_back();
    for (std::size_t i = 0; i < count; ++i) {
      const auto frame = static_cast<std::uint32_t>(i * posed.frames.size() / count);
      HeatMap map;
      map.size = size;
      map.shaded =
          shaded_fragments(posed.subject, frame, viewpoint, size, method.drawing.ranks(frame, viewpoint));
      std::uint64_t shaded = 0;
      std::uint64_t covered = 0;
      for (const std::uint32_t n : map.shaded) {
        shaded += n;
        covered += n > 0 ? 1 : 0;
      }
      const double ratio = covered > 0 ? static_cast<double>(shaded) / static_cast<double>(covered) : 0;
      const PosedFrame& at = posed.frames[frame];
      map.label = posed.clips.empty() ? fmt::format("{}: {:.3f}", method.name, ratio)
                                      : fmt::format("{}, {} {:.2f} s: {:.3f}", method.name,
                                                    posed.clips[at.clip].name, at.time, ratio);
      sheet.back().push_back(std::move(map));
    }
  }
  return sheet;
}

void write_images(const OverdrawCommandOptions& options, const OverdrawReport& report,
                  const PosedSubject& posed, const Compared& compared) {
  if (!options.chart.empty()) write_file_atomically(options.chart, overdraw_chart(report));
  if (options.report.empty() && options.heatmaps.empty()) return;
  constexpr std::uint32_t kHeatMapSize = 256;
  const std::vector<std::vector<HeatMap>> sheet = heat_maps(posed, compared, kHeatMapSize);
  if (!options.heatmaps.empty()) write_png(contact_sheet(sheet), options.heatmaps);
  if (!options.report.empty()) write_file_atomically(options.report, overdraw_html(report, sheet));
}

OverdrawReport new_report(const OverdrawCommandOptions& options, const PosedSubject& posed,
                          const OverdrawSets& sets) {
  OverdrawReport report;
  report.input = options.input;
  report.output = options.output;
  report.method = options.orders.method == OverdrawMethod::paper ? "paper" : "refined";
  report.lambda = options.orders.lambda;
  report.cache_size = options.orders.cache_size;
  report.viewpoints = 10 * (1U << (2 * options.orders.view_level)) + 2;
  report.size = options.orders.size;
  report.seed = options.orders.seed;
  report.joint = !options.per_animation;
  report.whole = options.subject.whole;
  report.triangles = posed.subject.triangles.size();
  report.vertices = posed.rest.size();
  report.parts = posed.parts.size();
  report.frames = posed.frames;
  for (const AnimationClip& clip : posed.clips) report.clips.push_back({clip.name, 0});
  for (const PosedFrame& frame : posed.frames) {
    if (!report.clips.empty()) ++report.clips[frame.clip].key_frames;
  }
  for (const OverdrawOrders& set : sets.sets) {
    report.patches = std::max(report.patches, set.run.patches);
    report.views += set.run.views;
    report.training_views += set.run.training_views;
    report.iterations = std::max(report.iterations, set.run.iterations);
    report.seconds.patches += set.run.seconds.patches;
    report.seconds.raster += set.run.seconds.raster;
    report.seconds.cluster += set.run.seconds.cluster;
    report.seconds.assign += set.run.seconds.assign;
    report.seconds.total += set.run.seconds.total;
  }
  report.measured_viewpoints = options.check_views;
  const std::uint64_t all = posed.frames.size() * std::uint64_t{options.check_views};
  report.measured_images = options.max_images > 0 ? std::min(all, options.max_images) : all;
  report.notes = posed.notes;
  return report;
}

// Prepares a model of a format other than glTF. A mesh without a material, and a material that is ordered,
// get what makes the orders valid.
void prepare(Model& model, SidesChoice sides) {
  if (is_gltf(model)) return;
  for (Primitive& primitive : model.primitives) {
    clean_for_writing(primitive, {});
    if (is_known_translucent(model, primitive)) continue;
    primitive.alpha_mode = AlphaMode::opaque;
    primitive.double_sided = sides == SidesChoice::both;
  }
}

void check_options(const OverdrawCommandOptions& options) {
  if (!options.output.empty()) check_output(options.output);
  for (const std::string& path : {options.report, options.chart, options.heatmaps}) {
    if (!path.empty()) check_writable(path);
  }
  const bool cannot_write = options.subject.subdivisions > 0 || options.subject.whole;
  if (!options.output.empty() && cannot_write) {
    throw Error(
        ErrorKind::bad_argument,
        "--subdivide and --whole are for measurements only: no file can hold such orders; leave out -o");
  }
  constexpr double kNoCache = 3;  // every triangle is a patch
  const bool writes = !options.output.empty();
  const bool refined = options.orders.method == OverdrawMethod::refined;
  const std::string no_output = "no model is written; give -o OUT.glb";
  refuse_without_effect(*options.command,
                        {needs("--acmr", refined, "--method paper takes cache misses from --lambda"),
                         needs("--acmr", options.orders.lambda < kNoCache,
                               "--lambda 3 draws triangles without regard to the cache"),
                         needs("--encoding", writes, no_output), needs("--split-buffer", writes, no_output),
                         needs("--embed-textures", writes, no_output)});
}

void refuse_for_subject(const OverdrawCommandOptions& options, const PosedSubject& posed) {
  const bool moves = !posed.clips.empty();
  const std::string nothing_moves = "nothing in " + options.input + " is animated";
  refuse_without_effect(*options.command, {needs("--keyframe-rate", moves, nothing_moves),
                                           needs("--joint", moves, nothing_moves),
                                           needs("--per-animation", moves, nothing_moves)});
}

void run_overdraw(OverdrawCommandOptions options, Session& session) {
  check_options(options);
  session.check_json();
  options.orders.seed = session.options().seed;
  options.orders.progress = session.progress();
  const Stopwatch total;
  begin_stage(session.progress(), "reading", 0);
  Model model = open_model(options.input, session);
  prepare(model, options.subject.sides);
  const PosedSubject posed = make_subject(model, options.subject);
  for (const std::string& note : posed.notes) session.note(model.path + ": " + note);
  stop_if_signalled();
  const double seconds_read = total.seconds();
  refuse_for_subject(options, posed);
  settle(options, posed);

  OverdrawSets sets =
      order_overdraw_sets(posed.subject, posed.frames, options.orders, !options.per_animation);
  const Stopwatch making_baselines;
  Compared compared = make_compared(options, posed, sets);
  const double seconds_baselines = making_baselines.seconds();
  Stopwatch measuring;
  std::vector<OverdrawRow> rows = measure_all(model, options, posed, compared, session);
  OverdrawReport report = new_report(options, posed, sets);
  report.seconds_measure = measuring.seconds();
  report.seconds_read = seconds_read;
  report.seconds_baselines = seconds_baselines;
  // The result is never worse than the order of the file.
  if (rows[0].key_frames.mean > rows[1].key_frames.mean) {
    report.notes.emplace_back(
        "the file's own order wastes fewer fragments than any order found, so it is kept");
    session.note(model.path + ": " + report.notes.back());
    sets = input_as_orders(posed, options.orders);
    rows[0] = rows[1];
    rows[0].name = report.method;
  }
  report.rows = std::move(rows);

  if (!options.output.empty()) {
    begin_stage(session.progress(), "writing", 0);
    const Stopwatch writing;
    const std::vector<OrderedPrimitive> ordered = ordered_primitives(posed, sets, options.orders);
    for (const OrderedPrimitive& entry : ordered)
      report.memory_bytes += index_bytes(entry.orders, model.primitives[entry.primitive].mesh);
    const WriteReport written = write_model(model, ordered, options.output, options.write);
    for (const std::string& note : written.notes) session.note(note);
    report.seconds_write = writing.seconds();
    report.disk_bytes = written.order_bytes;
    report.file_bytes = written.file_bytes;
    report.files = written.files;
  }
  write_images(options, report, posed, compared);
  report.seconds_total = total.seconds();
  report.peak_rss_bytes = peak_rss_bytes();
  session.print(to_text(report));
  session.write_json(to_json(report));
}

void add_order_group(CLI::App& command, OverdrawCommandOptions& o) {
  const char* group = "Orders";
  add_choice(command, "--method", o.orders.method,
             {{"refined", OverdrawMethod::refined}, {"paper", OverdrawMethod::paper}},
             "refined: least overdraw as counted (default); paper: patches by summed distance")
      ->group(group);
  command
      .add_option("--buffers", o.orders.buffers,
                  "Use N index buffers, 1 to 256 (default: 5, for a static model 1)")
      ->check(CLI::Range(1, 256))
      ->type_name("N")
      ->group(group);
  command
      .add_option("--views", o.views,
                  "Number of viewpoints that orders are made for: 12, 42, 162 or 642 (default: 162, for a "
                  "static model 642)")
      ->type_name("N")
      ->group(group);
  command
      .add_option(
          "--lambda", o.orders.lambda,
          "A patch ends when its cache misses per triangle fall below X, 0.3 to 3; 3: single triangles")
      ->check(CLI::Range(0.3, 3.0))
      ->type_name("X")
      ->capture_default_str()
      ->group(group);
  command
      .add_option_function<double>(
          "--acmr", [&o](double acmr) { o.orders.acmr = acmr; },
          "Cache misses per triangle that --method refined may have (default: those of --method paper with "
          "the same --lambda; static models without --lambda: those of meshopt_optimizeOverdraw)")
      ->check(CLI::Range(0.3, 3.0))
      ->type_name("X")
      ->group(group);
  command.add_option("--cache", o.orders.cache_size, "Optimise for a FIFO vertex cache of N vertices")
      ->check(CLI::Range(3, 1024))
      ->type_name("N")
      ->capture_default_str()
      ->group(group);
  command
      .add_option("--size", o.orders.size,
                  "Size of the square images that overdraw is counted in, pixels per side")
      ->check(CLI::Range(16, 4096))
      ->type_name("N")
      ->capture_default_str()
      ->group(group);
}

void add_model_group(CLI::App& command, OverdrawCommandOptions& o) {
  const char* group = "Model";
  command
      .add_option("--animation", o.subject.animations,
                  "Use only this animation, by name or number; may be given several times (default: all)")
      ->type_name("NAME")
      ->group(group);
  command
      .add_option_function<double>(
          "--keyframe-rate", [&o](double rate) { o.subject.keyframe_rate = rate; },
          "Key frames per second (default: the animation's own key times)")
      ->check(CLI::PositiveNumber)
      ->type_name("X")
      ->group(group);
  auto* joint =
      command.add_flag("--joint", o.joint, "Share the index buffers among all animations (default)")
          ->group(group);
  command.add_flag("--per-animation", o.per_animation, "Make index buffers for every animation by itself")
      ->excludes(joint)
      ->group(group);
  add_choice(command, "--sides", o.subject.sides,
             {{"auto", SidesChoice::automatic}, {"single", SidesChoice::single}, {"both", SidesChoice::both}},
             "Draw front faces only, or both sides (default auto: by the material's doubleSided, single "
             "without materials)")
      ->group(group);
  command
      .add_option("--subdivide", o.subject.subdivisions,
                  "Levels of Loop subdivision first, 0 to 3; not with -o")
      ->check(CLI::Range(0U, kMostSubdivisions))
      ->type_name("N")
      ->group(group);
  command
      .add_flag("--whole", o.subject.whole,
                "Treat all primitives as one draw call, as the paper does; not with -o")
      ->group(group);
}

void add_measurement_group(CLI::App& command, OverdrawCommandOptions& o) {
  const char* group = "Measurement";
  command
      .add_option("--baselines", o.baselines,
                  "Baselines to measure: all, none, or names of original,meshopt,per-frame,single,paper")
      ->type_name("LIST")
      ->capture_default_str()
      ->group(group);
  command
      .add_option("--check-views", o.check_views,
                  "Number of held-out viewpoints to measure from, 1.5 to 3 bounding radii away")
      ->check(CLI::Range(1, 100000))
      ->type_name("N")
      ->capture_default_str()
      ->group(group);
  command
      .add_option("--max-images", o.max_images,
                  "Measure about N images of all key frames x viewpoints, evenly chosen; 0: all")
      ->type_name("N")
      ->capture_default_str()
      ->group(group);
}

void add_output_group(CLI::App& command, OverdrawCommandOptions& o) {
  const char* group = "Output";
  command
      .add_option("-o,--output", o.output,
                  "The file to write: .glb or .gltf (default: measure and report only)")
      ->type_name("FILE")
      ->group(group);
  add_choice(command, "--encoding", o.write.encoding,
             {{"patches", OrderEncoding::patches},
              {"indices", OrderEncoding::indices},
              {"meshopt", OrderEncoding::meshopt}},
             "Store orders as patch ids (default), as plain indices, or as patch ids coded by meshopt")
      ->group(group);
  command
      .add_flag("--split-buffer", o.write.split_buffer, "Store orders in a file of their own, OUT.orders.bin")
      ->group(group);
  command
      .add_flag("--embed-textures", o.write.embed_textures,
                "Store textures of files beside the model in OUT; else a .gltf in another folder gets copies")
      ->group(group);
  command.add_option("--report", o.report, "Write an HTML page with table, chart and heat maps")
      ->type_name("FILE.html")
      ->group(group);
  command
      .add_option("--heatmaps", o.heatmaps,
                  "Write heat maps: a row for each method, a column for each key frame")
      ->type_name("FILE.png")
      ->group(group);
  command.add_option("--chart", o.chart, "Write a plot of overdraw over the animation")
      ->type_name("FILE.svg")
      ->group(group);
}

}  // namespace

void add_overdraw_command(CLI::App& app, Chosen& chosen) {
  auto options = std::make_shared<OverdrawCommandOptions>();
  options->write.encoding = OrderEncoding::patches;
  CLI::App* command = add_command(
      app, chosen, "overdraw", "Compute orders that reduce the overdraw of opaque models, static or animated",
      "  pellucid overdraw character.glb -o out.glb\n"
      "  pellucid overdraw character.glb -o out.glb --buffers 3 --animation Walk --animation Run\n"
      "  pellucid overdraw bunny.obj -o bunny.glb --report bunny.html\n"
      "  pellucid overdraw character.glb --method paper --lambda 0.75 --subdivide 1 --json stats.json\n"
      "  pellucid overdraw character.glb -o out.glb --per-animation --heatmaps sheet.png --chart ovr.svg",
      1, [options](Session& session) { run_overdraw(*options, session); });
  options->command = command;
  command->add_option("MODEL", options->input, "Model to read: glTF, GLB, PLY, OBJ, STL or OFF")
      ->required()
      ->type_name("");
  add_output_group(*command, *options);
  add_order_group(*command, *options);
  add_model_group(*command, *options);
  add_measurement_group(*command, *options);
  refuse_old_option(*command, "--viewpoints", "--views");
  refuse_old_option(*command, "--measure", "--check-views");
  refuse_old_option(*command, "--pictures", "--max-images");
}

}  // namespace pellucid::cli
