// Implements `pellucid measure`, which measures the orders of a file against exact images and beside
// baselines.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <optional>
#include <set>

#include "camera_options.h"
#include "choice.h"
#include "pellucid/report.h"
#include "pellucid/scene.h"
#include "session.h"

namespace pellucid::cli {
namespace {

constexpr std::uint32_t kImageSize = 480;

struct MeasureCommandOptions {
  const CLI::App* command = nullptr;  // knows which options were given
  std::vector<std::string> inputs;
  std::string original;
  std::uint32_t simplify = 0;
  MeasureSettings settings;
  std::string distance_range = "2,5";
  std::int64_t primitive = -1;
  std::optional<std::string> baselines;
  bool no_baselines = false;
  std::string report;
};

struct Input {
  std::string path, label;
  std::vector<std::string> names;  // of the primitives
  std::vector<CleanPrimitive> primitives;
};

void parse_distance_range(const std::string& text, MeasureSettings& settings) {
  int used = 0;
  const int read =
      std::sscanf(text.c_str(), "%lf,%lf%n", &settings.min_distance, &settings.max_distance, &used);
  if (read != 2 || static_cast<std::size_t>(used) != text.size() || !(settings.min_distance > 1) ||
      !(settings.max_distance >= settings.min_distance) || !std::isfinite(settings.max_distance)) {
    throw Error(ErrorKind::bad_argument,
                "--distance-range: '" + text + "' is not MIN,MAX in bounding radii with 1 < MIN <= MAX");
  }
}

// Notes that overdraw orders are not measured, because wrong pixels have no meaning for them.
void note_overdraw_orders(const Model& model, const Session& session) {
  const auto count = std::count_if(
      model.primitives.begin(), model.primitives.end(),
      [](const Primitive& primitive) { return primitive.orders && !has_transparency_orders(primitive); });
  if (count == 0) return;
  session.note(fmt::format("{}: the overdraw orders of {} primitive(s) are not measured", model.path, count));
}

// Reads the primitives that are measured: those with orders if `want_orders`, or else all.
Input read_input(const std::string& path, const std::string& label, bool want_orders,
                 std::uint32_t simplify_to, const Session& session) {
  Model model = open_model(path, session);
  if (want_orders) note_overdraw_orders(model, session);
  Input input{path, label, {}, {}};
  for (Primitive& primitive : model.primitives) {
    if (!primitive.triangles || primitive.mesh.triangles.empty()) continue;
    if (want_orders && !has_transparency_orders(primitive)) continue;
    CleanPrimitive clean = clean_primitive(primitive);
    if (simplify_to > 0 && clean.mesh.triangles.size() > simplify_to)
      clean.mesh = simplify(clean.mesh, simplify_to);
    if (clean.mesh.triangles.empty()) continue;
    input.names.push_back(primitive.name);
    input.primitives.push_back(std::move(clean));
  }
  return input;
}

// Returns the stems of the files, made different if some are the same.
std::vector<std::string> labels_of(const std::vector<std::string>& paths) {
  std::vector<std::string> labels;
  std::set<std::string> used(baseline_names().begin(), baseline_names().end());
  for (const std::string& path : paths) {
    const std::string stem = std::filesystem::path(path).stem().string();
    std::string label = stem;
    for (int k = 2; !used.insert(label).second; ++k) label = fmt::format("{}-{}", stem, k);
    labels.push_back(label);
  }
  return labels;
}

std::vector<Input> read_inputs(const MeasureCommandOptions& options, const Session& session) {
  const std::vector<std::string> labels = labels_of(options.inputs);
  std::vector<Input> inputs;
  for (std::size_t i = 0; i < options.inputs.size(); ++i) {
    inputs.push_back(read_input(options.inputs[i], labels[i], true, 0, session));
  }
  if (inputs.front().primitives.empty()) {
    if (inputs.size() > 1) {
      throw Error(ErrorKind::nothing_to_do, options.inputs.front() + ": there are no orders in it");
    }
    inputs.front() = read_input(options.inputs.front(), labels.front(), false, options.simplify, session);
  } else {
    refuse_without_effect(*options.command, {needs("--simplify", !options.original.empty(),
                                                   "it simplifies --original MODEL, which is not given")});
  }
  if (inputs.front().primitives.empty()) {
    throw Error(ErrorKind::nothing_to_do, options.inputs.front() + ": there are no triangles in it");
  }
  for (const Input& input : inputs) {
    if (input.primitives.size() != inputs.front().primitives.size()) {
      throw Error(
          ErrorKind::bad_argument,
          fmt::format("{}: {} ordered primitive(s), but {} has {}: they cannot be compared", input.path,
                      input.primitives.size(), inputs.front().path, inputs.front().primitives.size()));
    }
  }
  return inputs;
}

// Returns the mesh whose triangle order is the baseline `original`: the primitive of --original at the same
// position or, if the numbers of primitives differ, with the same name.
const Mesh* original_mesh(const Input& original, const Input& main, std::size_t k) {
  if (original.primitives.size() == main.primitives.size()) return &original.primitives[k].mesh;
  for (std::size_t i = 0; i < original.names.size(); ++i) {
    if (original.names[i] == main.names[k]) return &original.primitives[i].mesh;
  }
  throw Error(ErrorKind::bad_argument,
              fmt::format("{}: no primitive named '{}' as in {}", original.path, main.names[k], main.path));
}

struct ImageMaker {
  const CleanPrimitive* ordered;
  const Mesh* original;  // may be null
  double alpha;

  [[nodiscard]] ImageRow row(const std::string& title, const Viewpoint& view, Shading shading) const {
    ShadingOptions look;
    look.shading = shading;
    look.alpha = alpha;
    ImageRow row{title, {}};
    const Mesh& mesh = ordered->mesh;
    FragmentBuffer fragments;
    const Camera camera = draw(mesh, view, fragments);
    row.images.push_back({"exact", encode_png(shade_exact(mesh, camera, fragments, look))});
    const std::vector<std::uint32_t> ranks = ranks_from(mesh, *ordered->orders, view);
    const PixelCount wrong = count_incorrect_pixels(fragments, ranks);
    row.images.push_back(
        {"in-depth buffer", encode_png(shade_ordered(mesh, camera, fragments, ranks, look))});
    row.images.push_back(without_orders(view, look));
    const double ipr = wrong.foreground == 0
                           ? 0
                           : static_cast<double>(wrong.incorrect) / static_cast<double>(wrong.foreground);
    row.images.push_back({"wrong pixels: " + format_percent(ipr), encode_png(error_image(fragments, ranks))});
    return row;
  }

 private:
  Camera draw(const Mesh& mesh, const Viewpoint& view, FragmentBuffer& fragments) const {
    const Camera camera = look_at_sphere(bounding_sphere(mesh), view, kImageSize, kImageSize);
    RasterOptions raster;
    if (ordered->orders->facing == Facing::single) raster.culling = Culling::back;
    rasterize(mesh, camera, raster, fragments);
    return camera;
  }

  // Draws what a viewer shows without the orders.
  [[nodiscard]] ReportImage without_orders(const Viewpoint& view, const ShadingOptions& look) const {
    const Mesh& mesh = original != nullptr ? *original : ordered->mesh;
    FragmentBuffer fragments;
    const Camera camera = draw(mesh, view, fragments);
    const std::vector<std::uint32_t> ranks =
        original != nullptr ? ranks_as_stored(mesh.triangles.size())
                            : ranks_of_triangles(ordered->orders->base_sequence, mesh.triangles.size());
    return {original != nullptr ? "original order" : "best single order",
            encode_png(shade_ordered(mesh, camera, fragments, ranks, look))};
  }
};

std::vector<ImageRow> image_rows(const ImageMaker& maker, const MethodQuality& quality,
                                 const MeasureSettings& settings) {
  std::vector<ImageRow> rows;
  for (const char* camera : {"30,15,2.5", "150,-10,2.5", "265,35,2.5"}) {
    const Viewpoint view = parse_camera(camera);
    rows.push_back(maker.row(fmt::format("Azimuth, elevation, radii: {}; lit", camera), view, Shading::lit));
    rows.push_back(maker.row(fmt::format("Azimuth, elevation, radii: {}; depth as colour", camera), view,
                             Shading::depth));
  }
  const auto worst =
      std::max_element(quality.frames.begin(), quality.frames.end(),
                       [](const FrameError& a, const FrameError& b) { return a.ipr() < b.ipr(); });
  if (worst != quality.frames.end()) {
    const std::vector<Viewpoint> views =
        random_viewpoints(settings.viewpoints, settings.min_distance, settings.max_distance, settings.seed);
    const auto index = static_cast<std::size_t>(worst - quality.frames.begin());
    rows.push_back(maker.row(fmt::format("The worst of all {} viewpoints, at {} radii", settings.viewpoints,
                                         format_fixed(views[index].distance, 2)),
                             views[index], Shading::lit));
  }
  return rows;
}

std::string command_line(const MeasureCommandOptions& options) {
  std::string line = "pellucid measure";
  for (const std::string& input : options.inputs) line += " " + input;
  if (!options.original.empty()) line += " --original " + options.original;
  if (options.simplify > 0) line += fmt::format(" --simplify {}", options.simplify);
  if (options.baselines) line += " --baselines " + *options.baselines;
  const MeasureSettings& s = options.settings;
  return line + fmt::format(" --views {} --size {} --distance-range {} --seed {} --cache {} --alpha {}",
                            s.viewpoints, s.size, options.distance_range, s.seed, s.cache_size, s.alpha);
}

void write_report(const MeasureCommandOptions& options, const MeasureReport& report, const Input& main,
                  const std::vector<const Mesh*>& originals) {
  // The page shows the primitive with the most triangles.
  std::size_t shown = 0;
  for (std::size_t k = 1; k < report.primitives.size(); ++k) {
    if (report.primitives[k].triangles > report.primitives[shown].triangles) shown = k;
  }
  const CleanPrimitive& primitive = main.primitives[shown];
  if (!primitive.orders) {
    throw Error(ErrorKind::nothing_to_do, main.path + ": no orders to report on: run pellucid order first");
  }
  const ImageMaker maker{&primitive, originals[shown], options.settings.alpha};
  const std::vector<ImageRow> rows =
      image_rows(maker, report.primitives[shown].methods.front().quality, options.settings);
  HtmlReportInput page;
  page.title = main.label;
  page.measured = &report;
  page.primitive = shown;
  page.orders = &*primitive.orders;
  page.rows = rows;
  page.command = command_line(options);
  write_file_atomically(options.report, html_report(page));
}

// Removes all primitives but the one that --primitive names.
void keep_primitive(Input& input, std::int64_t k) {
  if (k < 0) return;
  const auto index = static_cast<std::size_t>(k);
  if (index >= input.primitives.size()) {
    throw Error(ErrorKind::bad_argument,
                fmt::format("--primitive {}: {} has {} to measure", k, input.path, input.primitives.size()));
  }
  input.names = {input.names[index]};
  CleanPrimitive kept = std::move(input.primitives[index]);
  input.primitives.clear();
  input.primitives.push_back(std::move(kept));
}

void run_measure(MeasureCommandOptions options, Session& session) {
  const Stopwatch watch;
  parse_distance_range(options.distance_range, options.settings);
  options.settings.seed = session.options().seed;
  if (options.no_baselines) options.baselines = "none";
  if (options.baselines) options.settings.baselines = parse_baselines(*options.baselines);
  if (!options.report.empty()) check_writable(options.report);
  session.check_json();
  begin_stage(session.progress(), "reading", 0);
  std::vector<Input> inputs = read_inputs(options, session);
  std::optional<Input> original;
  if (!options.original.empty())
    original = read_input(options.original, "original", false, options.simplify, session);
  std::vector<const Mesh*> originals;
  for (std::size_t k = 0; k < inputs.front().primitives.size(); ++k) {
    const bool unordered = !inputs.front().primitives[k].orders;
    if (original) {
      originals.push_back(original_mesh(*original, inputs.front(), k));
    } else {
      originals.push_back(unordered ? &inputs.front().primitives[k].mesh : nullptr);
    }
  }
  if (options.primitive >= 0) {
    for (Input& input : inputs) keep_primitive(input, options.primitive);
    const bool own = !original && originals[static_cast<std::size_t>(options.primitive)] != nullptr;
    originals = {own ? &inputs.front().primitives.front().mesh
                     : originals[static_cast<std::size_t>(options.primitive)]};
  }
  stop_if_signalled();

  MeasureReport report;
  report.inputs = options.inputs;
  report.settings = options.settings;
  report.overdraw_viewpoints = overdraw_viewpoints(options.settings);
  const Input& main = inputs.front();
  for (std::size_t k = 0; k < main.primitives.size(); ++k) {
    std::vector<MeasureSubject> subjects;
    for (const Input& input : inputs) {
      const CleanPrimitive& primitive = input.primitives[k];
      subjects.push_back({input.label, &primitive.mesh, primitive.orders ? &*primitive.orders : nullptr});
    }
    session.set_subject(main.primitives.size() == 1
                            ? main.label
                            : fmt::format("{}/{} {}", k + 1, main.primitives.size(), main.names[k]));
    report.primitives.push_back(
        measure_subjects(subjects, originals[k], main.names[k], options.settings, session.progress()));
  }
  session.set_subject("");
  report.seconds_total = watch.seconds();
  if (!options.report.empty()) write_report(options, report, main, originals);
  session.print(to_text(report));
  session.write_json(to_json(report));
}

}  // namespace

void add_measure_command(CLI::App& app, Chosen& chosen) {
  auto options = std::make_shared<MeasureCommandOptions>();
  MeasureCommandOptions& o = *options;
  CLI::App* command =
      add_command(app, chosen, "measure",
                  "Measure orders: wrong pixels, PSNR, overdraw and vertex cache misses, beside baselines",
                  "  pellucid measure bunny.glb --original bunny.ply\n"
                  "  pellucid measure budget.glb acyclic.glb --views 200 --size 512 --json both.json\n"
                  "  pellucid measure bunny.glb --original bunny.ply --simplify 10000 --report report.html\n"
                  "  pellucid measure bunny.glb --baselines all --views 100",
                  o.settings.seed, [options](Session& session) { run_measure(*options, session); });
  o.command = command;
  command->add_option("FILE", o.inputs, "Files with orders; several: of the same model, side by side")
      ->required()
      ->type_name("");
  const char* baseline_group = "Baselines";
  command
      ->add_option("--original", o.original,
                   "The model before ordering: its triangle order is measured as a baseline")
      ->type_name("MODEL")
      ->group(baseline_group);
  command
      ->add_option("--simplify", o.simplify,
                   "Simplify --original, or a model without orders, to N triangles as order --simplify does")
      ->type_name("N")
      ->group(baseline_group);
  CLI::Option* baselines =
      command
          ->add_option("--baselines", o.baselines,
                       "Baselines to measure: all, none, or names of "
                       "base,cache_optimized,centroid_sort,dptl,bsp (default: the first three)")
          ->type_name("LIST")
          ->group(baseline_group);
  command->add_flag("--no-baselines", o.no_baselines, "Measure the orders only: the same as --baselines none")
      ->excludes(baselines)
      ->group(baseline_group);
  const char* measurement_group = "Measurement";
  command->add_option("--views", o.settings.viewpoints, "Number of random viewpoints")
      ->check(CLI::Range(1U, 1000000U))
      ->type_name("N")
      ->capture_default_str()
      ->group(measurement_group);
  command
      ->add_option("--distance-range", o.distance_range, "Nearest and farthest viewpoint, in bounding radii")
      ->type_name("MIN,MAX")
      ->capture_default_str()
      ->group(measurement_group);
  command->add_option("--size", o.settings.size, "Size of the square images, pixels per side")
      ->check(CLI::Range(16U, 8192U))
      ->type_name("N")
      ->capture_default_str()
      ->group(measurement_group);
  command->add_option("--alpha", o.settings.alpha, "Opacity of a face for PSNR, 0 to 1")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str()
      ->group(measurement_group);
  command
      ->add_option("--cache", o.settings.cache_size,
                   "Count misses of a vertex cache of N vertices: FIFO, for ACMR also LRU")
      ->check(CLI::Range(3U, 1024U))
      ->type_name("N")
      ->capture_default_str()
      ->group(measurement_group);
  command
      ->add_option("--primitive", o.primitive,
                   "Measure only primitive N of those with orders, from 0 (default: all)")
      ->check(CLI::Range(0, 1 << 24))
      ->type_name("N")
      ->group(measurement_group);
  command->add_option("--report", o.report, "Write one self-contained HTML page")
      ->type_name("FILE")
      ->group("Output");
  refuse_old_option(*command, "--distances", "--distance-range");
}

}  // namespace pellucid::cli
