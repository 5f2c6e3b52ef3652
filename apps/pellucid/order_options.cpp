// The options of `pellucid order`: see order_options.h.
#include "order_options.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <filesystem>

#include "choice.h"
#include "order_outcome.h"
#include "pellucid/shading.h"
#include "session.h"

namespace pellucid::cli {
namespace {

// That --frontier shows and --max-error auto tries, unless --max-buffers says otherwise.
constexpr std::uint32_t kFrontierBuffers = 8;

// "1.5,3,inf". CLI11's own lists know no infinity.
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

void check_acyclic(const OrderCommandOptions& options) {
  const auto refuse = [](const std::string& option) {
    throw Error(ErrorKind::bad_argument,
                option + " needs --method budget: acyclic finds its own number of buffers");
  };
  if (options.buffers > 0) refuse("--buffers");
  if (options.order.least_frame_time) refuse("--max-error auto");
  if (!options.frontier.empty()) refuse("--frontier");
}

void check_options(const OrderCommandOptions& options) {
  if (options.output.empty() && options.frontier.empty() && !options.dry_run) {
    throw Error(ErrorKind::bad_argument, "no output file given: -o OUT.glb");
  }
  for (const std::string& path : options.frontier) check_frontier_path(path);
  if (options.order.method == OrderMethod::acyclic) check_acyclic(options);
  if (options.order.least_frame_time && options.buffers > 0)
    throw Error(ErrorKind::bad_argument, "--max-error auto chooses a number of buffers: not with --buffers");
  if (options.order.cache_size > 0 && options.order.cache_size < 3) {
    throw Error(ErrorKind::bad_argument,
                "--cache: a vertex cache holds at least 3 vertices (0: leave orders alone)");
  }
}

void add_method_options(CLI::App& command, OrderCommandOptions& o) {
  OrderOptions& order = o.order;
  add_choice(command, "--method", order.method,
             {{"budget", OrderMethod::budget}, {"acyclic", OrderMethod::acyclic}},
             "budget: fewest buffers within --max-error (default); acyclic: the paper's")
      ->group("Method");
  command.add_option("--views", o.views, "View cells: S2,2 or P3, T2, R2, ...")
      ->type_name("SPEC")
      ->capture_default_str()
      ->group("Method");
  auto* max_error =
      command
          .add_option_function<std::string>(
              "--max-error", [&order](const std::string& text) { parse_max_error(text, order); },
              "Share of wrong pixels to reach (when given and missed: exit 5); auto: the fewest buffers with "
              "which "
              "frames by verified hardly take longer")
          ->type_name("X|auto")
          ->default_str("0.001")
          ->group("Method");
  auto* min_psnr = command
                       .add_option("--min-psnr", order.min_psnr,
                                   "Instead: PSNR of the pictures to reach, dB; when missed: exit 5")
                       ->check(CLI::Range(1.0, kPerfectPsnr))
                       ->excludes(max_error)
                       ->group("Method");
  command
      .add_option("--alpha", order.alpha,
                  "Weigh errors by what is visible of them through faces of this opacity, 0 to 1")
      ->check(CLI::Range(0.001, 1.0))
      ->group("Method");
  auto* max_buffers = command.add_option("--max-buffers", order.max_buffers, "Never more buffers than this")
                          ->check(CLI::Range(1U, 65535U))
                          ->capture_default_str()
                          ->group("Method");
  auto* buffers =
      command.add_option("--buffers", o.buffers, "This many buffers, none of them unused (budget)")
          ->check(CLI::Range(1U, 65535U))
          ->excludes(max_buffers)
          ->group("Method");
  auto* frontier =
      command
          .add_option("--frontier", o.frontier,
                      "Plot error against buffers: FILE.svg, .json; --max-buffers is then 8; may repeat")
          ->type_name("FILE")
          ->allow_extra_args(false)
          ->excludes(buffers)
          ->group("Method");
  command.parse_complete_callback([&o, max_error, min_psnr, max_buffers, frontier] {
    o.target_given = (max_error->count() > 0 && !o.order.least_frame_time) || min_psnr->count() > 0;
    const bool tries_all = frontier->count() > 0 || o.order.least_frame_time;
    if (tries_all && max_buffers->count() == 0) o.order.max_buffers = kFrontierBuffers;
  });
  add_choice(command, "--priority", order.priority,
             {{"union", MergePriority::union_size},
              {"intersection", MergePriority::intersection},
              {"difference", MergePriority::difference}},
             "Which clusters merge first (acyclic; default union)")
      ->group("Method");
  command
      .add_option("--relax", order.fruitless_rounds, "Relaxation stops after N fruitless rounds (acyclic)")
      ->type_name("N")
      ->capture_default_str()
      ->group("Method");
  command
      .add_option("--upsample-from", order.upsample_from,
                  "Order N triangles, carry that over to all (0: never; default: from 10000 above 24000)")
      ->type_name("N")
      ->group("Method");
  command
      .add_option("--refine", order.refine_rounds,
                  "Rounds of repair on the full mesh after that (0: none, the paper's form)")
      ->type_name("N")
      ->check(CLI::Range(0U, 16U))
      ->capture_default_str()
      ->group("Method");
  command
      .add_option("--memory", order.memory,
                  "Get by with about this much, as in 4GB, by way of a temporary file")
      ->transform(CLI::AsSizeValue(false))
      ->type_name("SIZE")
      ->group("Method");
  command.add_option("--tolerance", order.tolerance, "Ignore overlaps thinner than this, in bounding radii")
      ->check(CLI::Range(0.0, 1.0))
      ->group("Method");
}

void add_camera_options(CLI::App& command, OrderCommandOptions& o) {
  OrderOptions& order = o.order;
  auto* distances =
      command
          .add_option("--distances", o.distances, "Camera distances to sample, in bounding radii: 1.5,3,inf")
          ->type_name("LIST")
          ->group("Cameras");
  auto* distance = command.add_option("--distance", o.distance, "One fixed camera distance")
                       ->check(CLI::Range(1.001, 1e6))
                       ->excludes(distances)
                       ->group("Cameras");
  auto* perspective = command.add_flag("--perspective", o.perspective, "Perspective cameras only")
                          ->excludes(distances)
                          ->group("Cameras");
  command.add_flag("--orthographic", o.orthographic, "Orthographic cameras only")
      ->excludes(distances)
      ->excludes(distance)
      ->excludes(perspective)
      ->group("Cameras");
  add_choice(command, "--occlusion", order.occlusion,
             {{"exact", OcclusionSource::exact}, {"raster", OcclusionSource::raster}},
             "Where occlusion comes from (default exact)")
      ->group("Cameras");
  command.add_option("--raster-size", order.raster_size, "Pixels per side of --occlusion raster")
      ->check(CLI::Range(16U, 8192U))
      ->capture_default_str()
      ->group("Cameras");
}

void add_mesh_options(CLI::App& command, OrderCommandOptions& o) {
  add_choice(command, "--facing", o.facing,
             {{"auto", FacingChoice::automatic},
              {"single", FacingChoice::single},
              {"duplicated", FacingChoice::duplicated}},
             "Faces that are drawn (default auto: the material's doubleSided)")
      ->group("Meshes");
  command.add_flag("--all", o.selection.all, "Also primitives of a glTF that are not BLEND")->group("Meshes");
  command.add_option("--material", o.selection.material, "Only primitives with this material")
      ->type_name("NAME")
      ->group("Meshes");
  command.add_option("--simplify", o.simplify, "Simplify to N triangles first (not glTF)")
      ->type_name("N")
      ->check(CLI::Range(1U, 1U << 28U))
      ->group("Meshes");
  command
      .add_flag("--strict", o.clean.strict, "Refuse degenerate and broken triangles, do not leave them out")
      ->group("Meshes");
  add_choice(command, "--duplicates", o.clean.duplicates,
             {{"keep", DuplicatePolicy::keep}, {"drop", DuplicatePolicy::drop}},
             "Triangles that are there twice (default keep)")
      ->group("Meshes");

  add_split_options(command, o.split);
}

void add_output_options(CLI::App& command, OrderCommandOptions& o) {
  command.add_option("--cache", o.order.cache_size, "FIFO vertex cache to optimise for; 0: not at all")
      ->check(CLI::Range(0U, 1024U))
      ->capture_default_str()
      ->group("Output");
  add_choice(command, "--cache-method", o.order.cache_method,
             {{"scheduled", CacheMethod::scheduled}, {"tipsify", CacheMethod::tipsify}},
             "scheduled (default), or the paper's tipsify")
      ->group("Output");
  command
      .add_option("--cache-slack", o.order.cache_slack,
                  "budget: wrong area that the cache may cost, square radii a view")
      ->check(CLI::NonNegativeNumber)
      ->type_name("X")
      ->capture_default_str()
      ->group("Output");
  add_choice(
      command, "--direction", o.write.direction,
      {{"front-to-back", SortDirection::front_to_back}, {"back-to-front", SortDirection::back_to_front}},
      "Stored direction (default front-to-back)")
      ->group("Output");
  add_choice(command, "--encoding", o.write.encoding,
             {{"indices", OrderEncoding::indices},
              {"patches", OrderEncoding::patches},
              {"meshopt", OrderEncoding::meshopt}},
             "How orders are stored (default indices)")
      ->group("Output");
  command.add_flag("--split-buffer", o.write.split_buffer, "Orders go to a file of their own beside OUT")
      ->group("Output");
  command.add_flag("--no-bake-base", o.no_bake_base, "Leave the file's own index buffer as it is")
      ->group("Output");
  command.add_option("--validate", o.validate, "Measure the error from N held-out viewpoints (0: do not)")
      ->type_name("N")
      ->capture_default_str()
      ->group("Output");
  command.add_flag("-n,--dry-run", o.dry_run, "Print what would be ordered, write nothing")->group("Output");
}

}  // namespace

void check_output(const std::string& path) {
  const std::string extension = std::filesystem::path(path).extension().string();
  if (extension != ".glb" && extension != ".gltf") {
    throw Error(ErrorKind::bad_argument, path + ": the output must end in .glb or .gltf");
  }
  check_writable(path);
}

void settle_options(OrderCommandOptions& options) {
  check_options(options);
  options.order.partition = parse_partition(options.views);
  options.order.distances = sample_distances(options);
  options.write.bake_base = !options.no_bake_base;
  if (options.buffers > 0) options.order.min_buffers = options.order.max_buffers = options.buffers;
}

void add_order_options(CLI::App& command, OrderCommandOptions& options) {
  add_run_options(command, options.run);
  command
      .add_option("-o,--output", options.output,
                  "The file to write: .glb or .gltf; for several models a folder: OUTDIR/")
      ->type_name("FILE");
  add_method_options(command, options);
  add_camera_options(command, options);
  add_mesh_options(command, options);
  add_output_options(command, options);
}

}  // namespace pellucid::cli
