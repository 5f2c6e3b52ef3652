// Implements order_options.h: the options of `pellucid order`.
#include "order_options.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <filesystem>

#include "choice.h"
#include "pellucid/shading.h"
#include "session.h"

namespace pellucid::cli {
namespace {

// The largest number of buffers of --frontier and --max-error auto, unless --max-buffers is given.
constexpr std::uint32_t kFrontierBuffers = 8;

// Reads "1.5,3,inf". The lists of CLI11 do not accept inf.
std::vector<double> parse_distances(const std::string& text) {
  std::vector<double> distances;
  std::size_t begin = 0;
  while (begin <= text.size()) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    const std::string item = text.substr(begin, end - begin);
    char* rest = nullptr;
    const double value = item == "inf" ? kInfiniteDistance : std::strtod(item.c_str(), &rest);
    if (item.empty() || (rest != nullptr && *rest != '\0') || !(value > 1)) {
      throw Error(ErrorKind::bad_argument,
                  fmt::format("--distances: '{}' is not a distance above 1 bounding radius (or inf)", item));
    }
    distances.push_back(value);
    begin = end + 1;
  }
  return distances;
}

void parse_max_error(const std::string& text, OrderOptions& order) {
  order.least_frame_time = text == "auto";
  if (order.least_frame_time) return;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), order.max_error);
  const bool is_read = error == std::errc() && end == text.data() + text.size();
  if (!is_read || !(order.max_error >= 0 && order.max_error <= 1)) {
    throw CLI::ValidationError("--max-error: '" + text + "' is neither a share of 0 to 1 nor auto");
  }
}

std::vector<double> sample_distances(const OrderCommandOptions& options) {
  if (options.distance > 0) return {options.distance};
  if (!options.distances.empty()) return parse_distances(options.distances);
  if (options.orthographic) return {kInfiniteDistance};
  std::vector<double> distances = default_distances();
  if (options.perspective) std::erase_if(distances, [](double d) { return std::isinf(d); });
  return distances;
}

void check_frontier_path(const std::string& path) {
  if (!is_plot(path) && std::filesystem::path(path).extension() != ".json") {
    throw Error(ErrorKind::bad_argument, path + ": a frontier is written as .json or .svg");
  }
  check_writable(path);
}

void check_options(const OrderCommandOptions& options) {
  if (options.output.empty() && options.frontier.empty() && !options.dry_run) {
    throw Error(ErrorKind::bad_argument, "no output file given: -o OUT.glb");
  }
  if (options.order.least_frame_time && options.buffers > 0)
    throw Error(ErrorKind::bad_argument, "--max-error auto chooses a number of buffers: not with --buffers");
  if (options.order.cache_size > 0 && options.order.cache_size < 3) {
    throw Error(ErrorKind::bad_argument,
                "--cache: a vertex cache holds at least 3 vertices (0: leave orders alone)");
  }
}

void refuse_ineffective(const OrderCommandOptions& o) {
  const OrderOptions& order = o.order;
  const bool budget = order.method == OrderMethod::budget;
  const bool raster = order.occlusion == OcclusionSource::raster;
  const bool scheduled = order.cache_method == CacheMethod::scheduled;
  const bool writes = !o.output.empty();
  // acyclic does not aim at an error, but its error from held-out viewpoints is still compared with the
  // target.
  const bool checks_error = budget || (o.check_views > 0 && !order.least_frame_time);
  const std::string own_number = "--method acyclic finds its own number of buffers";
  const std::string no_target = "--method acyclic aims at no error, and nothing measures it";
  const std::string no_output = "no model is written; give -o OUT.glb";
  const std::string only_plans = "--dry-run only prints a plan";
  refuse_without_effect(
      *o.command,
      {needs("--max-error", checks_error, order.least_frame_time ? own_number : no_target),
       needs("--min-psnr", checks_error, no_target),
       needs("--max-buffers", budget, own_number),
       needs("--buffers", budget, own_number),
       needs("--frontier", budget, own_number),
       needs("--frontier", !o.dry_run, only_plans),
       needs("--priority", !budget, "only --method acyclic merges clusters by priority"),
       needs("--relax", !budget, "only --method acyclic relaxes clusters"),
       needs("--refine", order.upsample_from != 0U, "with --upsample-from 0 nothing is carried over"),
       needs("--tolerance", !raster || is_continuous(order.partition),
             "--occlusion raster compares no triangles, except for partitions T and R"),
       needs("--raster-size", raster, "only --occlusion raster draws images"),
       needs("--perspective", !(o.distance > 0), "a camera at one --distance is in perspective"),
       needs("--all", o.selection.material.empty(), "--material selects primitives of any alphaMode"),
       needs("--split-limit", o.split.split, "only --split makes new triangles"),
       needs("--cache-method", order.cache_size > 0, "--cache 0 leaves orders alone"),
       needs("--cache-slack", order.cache_size > 0, "--cache 0 leaves orders alone"),
       needs("--cache-slack", budget, "--method acyclic allows the vertex cache no wrong area"),
       needs("--cache-slack", scheduled, "--cache-method tipsify has no slack"),
       needs("--direction", writes || o.dry_run, no_output),
       needs("--encoding", writes || o.dry_run, no_output),
       needs("--split-buffer", writes || o.dry_run, no_output),
       needs("--embed-textures", writes || o.dry_run, no_output),
       needs("--no-bake-base", writes || o.dry_run, no_output),
       needs("--check-views", writes || o.dry_run, no_output),
       needs("--skip-existing", writes, no_output),
       needs("--skip-existing", !o.dry_run, only_plans),
       needs("--checkpoint", !o.dry_run, only_plans),
       needs("--json", !o.dry_run, only_plans)});
}

void add_method_options(CLI::App& command, OrderCommandOptions& o) {
  const char* group = "Method";
  OrderOptions& order = o.order;
  add_choice(command, "--method", order.method,
             {{"budget", OrderMethod::budget}, {"acyclic", OrderMethod::acyclic}},
             "budget: the fewest buffers within --max-error (default); acyclic: the paper's clustering")
      ->group(group);
  command
      .add_option("--partition", o.partition,
                  "View cells: S2,2 is 320 sampled triangles, P3 642 viewpoints; also T2, R2")
      ->type_name("SPEC")
      ->capture_default_str()
      ->group(group);
  auto* max_error =
      command
          .add_option_function<std::string>(
              "--max-error", [&order](const std::string& text) { parse_max_error(text, order); },
              "Share of wrong pixels to reach, 0 to 1; exit 5 when given and missed. auto: the fewest "
              "buffers with which frames of technique verified take at most 5 % longer")
          ->type_name("X|auto")
          ->default_str("0.001")
          ->group(group);
  auto* min_psnr =
      command
          .add_option("--min-psnr", order.min_psnr,
                      "PSNR of the images to reach, dB, instead of --max-error; exit 5 when missed")
          ->check(CLI::Range(1.0, kPerfectPsnr))
          ->excludes(max_error)
          ->group(group);
  command
      .add_option("--alpha", order.alpha,
                  "Opacity of a face, 0 to 1: errors count by the light that reaches them (default: by area)")
      ->check(CLI::Range(0.001, 1.0))
      ->group(group);
  auto* max_buffers = command.add_option("--max-buffers", order.max_buffers, "Use at most N buffers")
                          ->check(CLI::Range(1U, 65535U))
                          ->capture_default_str()
                          ->group(group);
  auto* buffers =
      command
          .add_option("--buffers", o.buffers, "Use exactly N buffers; fewer only where one serves no view")
          ->check(CLI::Range(1U, 65535U))
          ->excludes(max_buffers)
          ->group(group);
  auto* frontier =
      command
          .add_option("--frontier", o.frontier,
                      "Write the Pareto front of error against buffers to FILE.json or FILE.svg, up to "
                      "--max-buffers (then 8 by default); may be given several times")
          ->type_name("FILE")
          ->allow_extra_args(false)
          ->excludes(buffers)
          ->group(group);
  command.parse_complete_callback([&o, max_error, min_psnr, max_buffers, frontier] {
    o.target_given = (max_error->count() > 0 && !o.order.least_frame_time) || min_psnr->count() > 0;
    const bool tries_all = frontier->count() > 0 || o.order.least_frame_time;
    if (tries_all && max_buffers->count() == 0) o.order.max_buffers = kFrontierBuffers;
  });
  add_choice(command, "--priority", order.priority,
             {{"union", MergePriority::union_size},
              {"intersection", MergePriority::intersection},
              {"difference", MergePriority::difference}},
             "Which clusters --method acyclic merges first (default union)")
      ->group(group);
  command
      .add_option("--relax", order.fruitless_rounds,
                  "Stop the relaxation of --method acyclic after N rounds without progress")
      ->type_name("N")
      ->capture_default_str()
      ->group(group);
  command
      .add_option("--upsample-from", order.upsample_from,
                  "Order the mesh simplified to N triangles and carry that over to all; 0: never (default: "
                  "10000 for meshes above 24000)")
      ->type_name("N")
      ->group(group);
  command
      .add_option(
          "--refine", order.refine_rounds,
          "Rounds of repair on the full mesh after --upsample-from, 0 to 16; 0: none, as in the paper")
      ->type_name("N")
      ->check(CLI::Range(0U, 16U))
      ->capture_default_str()
      ->group(group);
  command
      .add_option("--memory", order.memory,
                  "Use about this much host memory, as in 4GB; the rest goes to a temporary file (default: "
                  "no limit)")
      ->transform(CLI::AsSizeValue(true))
      ->type_name("SIZE")
      ->group(group);
  command
      .add_option("--tolerance", order.tolerance,
                  "Ignore overlaps thinner than X bounding radii (default: 0, for acyclic 0.003)")
      ->check(CLI::Range(0.0, 1.0))
      ->group(group);
}

void add_camera_options(CLI::App& command, OrderCommandOptions& o) {
  const char* group = "Cameras";
  OrderOptions& order = o.order;
  auto* distances =
      command
          .add_option("--distances", o.distances,
                      "Camera distances to sample, in bounding radii, as in 1.5,3,inf (default: "
                      "a spread with inf)")
          ->type_name("LIST")
          ->group(group);
  auto* distance = command.add_option("--distance", o.distance, "One camera distance, in bounding radii")
                       ->check(CLI::Range(1.001, 1e6))
                       ->excludes(distances)
                       ->group(group);
  auto* perspective =
      command.add_flag("--perspective", o.perspective, "Perspective cameras only: the spread without inf")
          ->excludes(distances)
          ->group(group);
  command.add_flag("--orthographic", o.orthographic, "Orthographic cameras only: distance inf")
      ->excludes(distances)
      ->excludes(distance)
      ->excludes(perspective)
      ->group(group);
  add_choice(command, "--occlusion", order.occlusion,
             {{"exact", OcclusionSource::exact}, {"raster", OcclusionSource::raster}},
             "Find occlusion by pairs of triangles (default exact) or in images")
      ->group(group);
  command
      .add_option("--raster-size", order.raster_size, "Pixels per side of the images of --occlusion raster")
      ->check(CLI::Range(16U, 8192U))
      ->capture_default_str()
      ->group(group);
}

void add_mesh_options(CLI::App& command, OrderCommandOptions& o) {
  const char* group = "Meshes";
  add_choice(command, "--facing", o.facing,
             {{"auto", FacingChoice::automatic},
              {"single", FacingChoice::single},
              {"duplicated", FacingChoice::duplicated}},
             "Order front faces only, or both (default auto: by the material's doubleSided)")
      ->group(group);
  command.add_flag("--all", o.selection.all, "Order also primitives that are not BLEND")->group(group);
  command.add_option("--material", o.selection.material, "Order only primitives with this material")
      ->type_name("NAME")
      ->group(group);
  command.add_option("--simplify", o.simplify, "Simplify the model to N triangles first; not for glTF")
      ->type_name("N")
      ->check(CLI::Range(1U, 1U << 28U))
      ->group(group);
  add_choice(command, "--duplicates", o.clean.duplicates,
             {{"keep", DuplicatePolicy::keep}, {"drop", DuplicatePolicy::drop}},
             "What to do with triangles that occur twice (default keep)")
      ->group(group);
  command
      .add_flag("--split", o.split.split,
                "Cut faces that intersect or overlap in cycles: no order is right for them")
      ->group(group);
  command
      .add_option("--split-limit", o.split.limit,
                  "Add at most this share of the primitive's triangles by --split")
      ->check(CLI::Range(0.0, 100.0))
      ->type_name("X")
      ->capture_default_str()
      ->group(group);
}

void add_cache_options(CLI::App& command, OrderCommandOptions& o) {
  const char* group = "Vertex cache";
  command
      .add_option("--cache", o.order.cache_size,
                  "Optimise for a FIFO vertex cache of N vertices; 0: leave orders alone")
      ->type_name("N")
      ->check(CLI::Range(0U, 1024U))
      ->capture_default_str()
      ->group(group);
  add_choice(command, "--cache-method", o.order.cache_method,
             {{"scheduled", CacheMethod::scheduled}, {"tipsify", CacheMethod::tipsify}},
             "scheduled: list scheduling and a search (default); tipsify: the paper's")
      ->group(group);
  command
      .add_option("--cache-slack", o.order.cache_slack,
                  "Wrong area that the vertex cache may cost with --method budget, square bounding radii per "
                  "view")
      ->check(CLI::NonNegativeNumber)
      ->type_name("X")
      ->capture_default_str()
      ->group(group);
}

void add_output_options(CLI::App& command, OrderCommandOptions& o) {
  const char* group = "Output";
  command
      .add_option("-o,--output", o.output,
                  "The file to write: .glb or .gltf; for several models a folder: OUTDIR/")
      ->type_name("FILE")
      ->group(group);
  add_choice(
      command, "--direction", o.write.direction,
      {{"front-to-back", SortDirection::front_to_back}, {"back-to-front", SortDirection::back_to_front}},
      "Direction of the stored orders (default front-to-back)")
      ->group(group);
  add_choice(command, "--encoding", o.write.encoding,
             {{"indices", OrderEncoding::indices},
              {"patches", OrderEncoding::patches},
              {"meshopt", OrderEncoding::meshopt}},
             "Store orders as plain indices (default), as patch ids, or as patch ids coded by meshopt")
      ->group(group);
  command
      .add_flag("--split-buffer", o.write.split_buffer, "Store orders in a file of their own, OUT.orders.bin")
      ->group(group);
  command
      .add_flag("--embed-textures", o.write.embed_textures,
                "Store textures of files beside the model in OUT; else a .gltf in another folder gets copies")
      ->group(group);
  command.add_flag("--no-bake-base", o.no_bake_base, "Leave the file's own index buffer as it is")
      ->group(group);
  command
      .add_option("--check-views", o.check_views,
                  "Measure the error from N held-out viewpoints and store it; 0: do not measure")
      ->type_name("N")
      ->capture_default_str()
      ->group(group);
  command
      .add_flag("-n,--dry-run", o.dry_run,
                "Print what would be ordered and how large it may get; write nothing")
      ->group(group);
}

}  // namespace

void check_output(const std::string& path) {
  const std::string extension = std::filesystem::path(path).extension().string();
  if (extension != ".glb" && extension != ".gltf") {
    throw Error(ErrorKind::bad_argument, path + ": the output must end in .glb or .gltf");
  }
  check_writable(path);
}

bool is_plot(const std::string& path) {
  return std::filesystem::path(path).extension() == ".svg";
}

void settle_options(OrderCommandOptions& options) {
  check_options(options);
  options.order.partition = parse_partition(options.partition);
  refuse_ineffective(options);
  for (const std::string& path : options.frontier) check_frontier_path(path);
  options.order.distances = sample_distances(options);
  options.write.bake_base = !options.no_bake_base;
  if (options.buffers > 0) options.order.min_buffers = options.order.max_buffers = options.buffers;
}

void refuse_for_model(const OrderCommandOptions& options, const Model& model) {
  const bool has_materials = is_gltf(model) || model.format == "obj";
  refuse_without_effect(
      *options.command,
      {needs("--all", has_materials, "all primitives of a ." + model.format + " file are ordered"),
       needs("--material", has_materials, "a ." + model.format + " file has no materials")});
}

void add_order_options(CLI::App& command, OrderCommandOptions& options) {
  options.command = &command;
  add_output_options(command, options);
  add_method_options(command, options);
  add_camera_options(command, options);
  add_mesh_options(command, options);
  add_cache_options(command, options);
  add_run_options(command, options.run);
  refuse_old_option(command, "--views", "--partition");
  refuse_old_option(command, "--validate", "--check-views");
  refuse_old_option(command, "--list", "--model-list");
}

}  // namespace pellucid::cli
