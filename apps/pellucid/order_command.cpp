// pellucid order: transparency orders for the static meshes of a model.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <optional>

#include "choice.h"
#include "cleaned.h"
#include "order_batch.h"
#include "order_outcome.h"
#include "pellucid/checkpoint.h"
#include "pellucid/cycles.h"
#include "pellucid/frontier_report.h"
#include "pellucid/report.h"
#include "pellucid/shading.h"
#include "selection.h"
#include "session.h"
#include "splitting.h"
#include "terminal_progress.h"

namespace pellucid::cli {
namespace {

// Held-out viewpoints, so that the recorded error is none that the method has trained on.
constexpr std::uint64_t kValidationSeed = 0x5EEDED;
constexpr std::uint32_t kValidationSize = 512;
constexpr std::uint32_t kFrontierBuffers = 8;  // that --frontier shows unless --max-buffers says otherwise
// Lists hold most triangles twice: 1.45 to 1.6 times the triangles on closed meshes.
constexpr double kTypicalTwins = 1.6;

enum class FacingChoice { automatic, single, duplicated };

struct OrderCommandOptions {
  RunOptions run;
  std::string input, output;  // of the file at hand; at first the output as it was given
  std::string checkpoint;     // of the file at hand
  OrderOptions order;
  std::string views = "S2,2";
  std::string distances;
  double distance = 0;
  bool perspective = false, orthographic = false;
  std::uint32_t buffers = 0;
  bool target_given = false;  // --max-error or --min-psnr
  std::vector<std::string> frontier;
  FacingChoice facing = FacingChoice::automatic;
  SelectionOptions selection;
  CleanOptions clean;
  SplitChoice split;
  std::uint32_t simplify = 0;
  WriteOptions write;
  bool no_bake_base = false;
  std::uint32_t validate = 60;
  bool dry_run = false;
};

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

std::vector<double> sample_distances(const OrderCommandOptions& options) {
  if (options.distance > 0) return {options.distance};
  if (!options.distances.empty()) return parse_distances(options.distances);
  if (options.orthographic) return {kInfiniteDistance};
  std::vector<double> distances = default_distances();
  if (options.perspective) std::erase_if(distances, [](double d) { return std::isinf(d); });
  return distances;
}

void check_output(const std::string& path) {
  const std::string extension = std::filesystem::path(path).extension().string();
  if (extension != ".glb" && extension != ".gltf") {
    throw Error(ErrorKind::bad_argument, path + ": the output must end in .glb or .gltf");
  }
  check_writable(path);
}

void check_acyclic(const OrderCommandOptions& options) {
  const auto refuse = [](const std::string& option) {
    throw Error(ErrorKind::bad_argument,
                option + " needs --method budget: acyclic finds its own number of buffers");
  };
  if (options.buffers > 0) refuse("--buffers");
  if (!options.frontier.empty()) refuse("--frontier");
}

void check_options(const OrderCommandOptions& options) {
  if (options.output.empty() && options.frontier.empty() && !options.dry_run) {
    throw Error(ErrorKind::bad_argument, "no output file given: -o OUT.glb");
  }
  for (const std::string& path : options.frontier) check_frontier_path(path);
  if (options.order.method == OrderMethod::acyclic) check_acyclic(options);
  if (options.order.cache_size > 0 && options.order.cache_size < 3) {
    throw Error(ErrorKind::bad_argument,
                "--cache: a vertex cache holds at least 3 vertices (0: leave orders alone)");
  }
}

Facing facing_of(const Model& model, const Primitive& primitive, FacingChoice choice) {
  if (choice == FacingChoice::single) return Facing::single;
  if (choice == FacingChoice::duplicated) return Facing::duplicated;
  return is_gltf(model) && !primitive.double_sided ? Facing::single : Facing::duplicated;
}

// Formats other than glTF are written anew: what cannot be drawn is left out for good, and the mesh may be
// simplified.
void prepare_mesh(Primitive& primitive, const OrderCommandOptions& options, std::uint32_t target) {
  primitive.mesh = compacted(clean(primitive.mesh, options.clean, primitive.name).mesh);
  if (target > 0 && primitive.mesh.triangles.size() > target) {
    primitive.mesh = simplify(primitive.mesh, target);
    if (!primitive.mesh.triangles.empty()) primitive.mesh.normals = vertex_normals(primitive.mesh);
  }
}

// `--simplify N` is the size of the whole model: every primitive gets its share.
std::vector<MeshReport> prepare_model(Model& model, const Selection& selection,
                                      const OrderCommandOptions& options) {
  std::vector<MeshReport> reports;
  std::uint64_t triangles = 0;
  for (const std::uint32_t i : selection.primitives) {
    reports.push_back(check(model.primitives[i].mesh));
    triangles += model.primitives[i].mesh.triangles.size();
  }
  if (is_gltf(model)) {
    if (options.simplify > 0) {
      throw Error(ErrorKind::bad_argument,
                  model.path + ": --simplify would lose a glTF's texture coordinates: simplify it before");
    }
    return reports;
  }
  for (const std::uint32_t i : selection.primitives) {
    const double share =
        static_cast<double>(model.primitives[i].mesh.triangles.size()) / static_cast<double>(triangles);
    const double target = options.simplify == 0 ? 0 : std::max(1.0, std::round(share * options.simplify));
    prepare_mesh(model.primitives[i], options, static_cast<std::uint32_t>(target));
  }
  return reports;
}

// Fills what the report says of the error from held-out viewpoints.
void validate_orders(const Mesh& mesh, const OrderSet& orders, std::uint32_t viewpoints, double alpha,
                     Session& session, PrimitiveOrderReport& report) {
  MeasureOptions measure;
  measure.viewpoints = viewpoints;
  measure.size = kValidationSize;
  measure.seed = kValidationSeed ^ session.options().seed;
  measure.facing = orders.facing;
  measure.shading.alpha = alpha;
  // The paper's range of 2 to 5 radii, as far as the orders were made for it.
  measure.min_distance = std::max(2.0, orders.valid_from);
  measure.max_distance = std::max(measure.min_distance, std::min(5.0, orders.valid_to));
  measure.progress = session.progress();
  std::vector<DrawingMethod> methods{
      {"orders", [&](const Viewpoint& viewpoint) { return ranks_from(mesh, orders, viewpoint); }}};
  // What no order gets right, where something hints at it.
  if (report.statistics.intersecting_pairs > 0 || report.statistics.cyclic_cells > 0) {
    methods.push_back({"best", [&](const Viewpoint& viewpoint) {
                         return best_ranks(mesh, orders.sphere, viewpoint, measure.size, orders.facing);
                       }});
  }
  const std::vector<MethodQuality> qualities = measure_order_quality(mesh, methods, measure);
  const MethodQuality& quality = qualities.front();
  OrderErrorRecord record;
  record.viewpoints = viewpoints;
  record.size = measure.size;
  record.ipr_mean = quality.ipr_mean;
  record.ipr_max = quality.ipr_max;
  record.psnr_mean = quality.psnr_mean;
  for (const DistanceError& bin : quality.by_distance) record.by_distance.push_back({bin.distance, bin.ipr});
  report.error = record;
  if (qualities.size() > 1) report.ipr_unavoidable = qualities.back().ipr_mean;
}

std::optional<SplitReport> split_one(Model& model, std::uint32_t index, const OrderCommandOptions& options,
                                     Session& session) {
  OrderOptions order = options.order;
  order.facing = facing_of(model, model.primitives[index], options.facing);
  return split_primitive(model, index, options.split, options.clean, order, session);
}

struct OrderedOne {
  OrderedPrimitive ordered;
  PrimitiveOrderReport report;
  PrimitiveFrontier frontier;  // --frontier; without -o there is nothing else
};

OrderedOne order_one(const Model& model, std::uint32_t index, const OrderCommandOptions& options,
                     Session& session, double& seconds_validate) {
  const Primitive& primitive = model.primitives[index];
  const CleanMesh clean_mesh = clean(primitive.mesh, options.clean, model.path + ": " + primitive.name);
  const Mesh& mesh = clean_mesh.mesh;
  if (mesh.triangles.empty()) {
    throw Error(ErrorKind::nothing_to_do,
                fmt::format("{}: {}: no triangle is left after cleaning", model.path, primitive.name));
  }
  OrderOptions order = options.order;
  order.facing = facing_of(model, primitive, options.facing);
  order.progress = session.progress();
  OrderedOne one;
  OrderResult result;
  if (options.frontier.empty()) {
    result = order_mesh(mesh, order);
  } else {
    one.frontier = {primitive.name, index, mesh.triangles.size(), mesh.positions.size(),
                    order_frontier(mesh, order, !options.output.empty())};
    if (options.output.empty()) return one;
    result = std::move(*one.frontier.frontier.result);
  }
  one.ordered.primitive = index;
  PrimitiveOrderReport& report = one.report;
  report.statistics = result.statistics;
  if (options.validate > 0) {
    const Stopwatch watch;
    validate_orders(mesh, result.orders, options.validate, picture_alpha(order), session, report);
    one.ordered.error = report.error;
    seconds_validate += watch.seconds();
  }
  const std::uint32_t cache = order.cache_size > 0 ? order.cache_size : OrderOptions{}.cache_size;
  NodeSequence stored(mesh.triangles.size());
  for (std::uint32_t t = 0; t < stored.size(); ++t) stored[t] = node_of(t, false);
  report.name = primitive.name;
  report.primitive = index;
  report.triangles = mesh.triangles.size();
  report.vertices = mesh.positions.size();
  report.check = clean_mesh.report;
  report.acmr_before = sequence_statistics(mesh, stored, CacheModel::fifo, cache).acmr;
  report.buffers = buffer_statistics(mesh, result.orders, CacheModel::fifo, cache);
  report.memory_bytes = index_bytes(result.orders, mesh);
  one.ordered.orders = lift_orders(std::move(result.orders), clean_mesh.source);
  return one;
}

void print_plan(const Model& model, const Selection& selection, const OrderCommandOptions& options,
                Session& session) {
  TextTable table({"primitive", "material", "triangles", "facing", "one buffer", "at most"});
  const std::uint64_t most = options.order.method == OrderMethod::budget ? options.order.max_buffers : 0;
  for (const std::uint32_t i : selection.primitives) {
    const Primitive& primitive = model.primitives[i];
    const Facing facing = facing_of(model, primitive, options.facing);
    const double list = static_cast<double>(primitive.mesh.triangles.size()) *
                        (facing == Facing::duplicated ? kTypicalTwins : 1.0);
    const std::uint64_t bytes =
        static_cast<std::uint64_t>(list) * 3 * (primitive.mesh.positions.size() < 65535 ? 2 : 4);
    table.add_row({primitive.name, primitive.material_name.empty() ? "(none)" : primitive.material_name,
                   format_count(primitive.mesh.triangles.size()),
                   facing == Facing::single ? "single" : "duplicated", format_bytes(bytes),
                   most == 0 ? "-" : format_bytes(most * bytes)});
  }
  session.print(table.to_string());
  session.print("dry run: nothing was written; sizes are estimates\n");
}

FrontierReport new_frontier_report(const OrderCommandOptions& options) {
  FrontierReport report;
  report.input = options.input;
  report.views = to_string(options.order.partition);
  report.distances = options.order.distances;
  report.seed = options.order.seed;
  report.alpha = options.order.alpha;
  report.picture_alpha = picture_alpha(options.order);
  report.max_error = options.order.max_error;
  report.min_psnr = options.order.min_psnr;
  return report;
}

OrderReport new_report(const OrderCommandOptions& options) {
  OrderReport report;
  report.input = options.input;
  report.output = options.output;
  report.method = options.order.method == OrderMethod::budget ? "budget" : "acyclic";
  report.views = to_string(options.order.partition);
  report.seed = options.order.seed;
  report.cache_size = options.order.cache_size;
  report.cache_method = options.order.cache_method == CacheMethod::tipsify ? "tipsify" : "scheduled";
  report.alpha = options.order.alpha;
  report.picture_alpha = picture_alpha(options.order);
  report.distances = options.order.distances;
  return report;
}

void dry_run(const OrderCommandOptions& options, Session& session) {
  const Model model = read_model(options.input);
  const Selection selection = select_primitives(model, options.selection);
  for (const std::string& note : selection.notes) session.note(model.path + ": " + note);
  print_plan(model, selection, options, session);
}

struct FileOutcome {
  OrderReport report;  // without -o: empty
  std::vector<Reached> reached;
};

FileOutcome order_file(OrderCommandOptions options, Session& session) {
  FileOutcome done;
  const Stopwatch total;
  OrderReport report = new_report(options);
  begin_stage(session.progress(), "reading", 0);
  Model model = read_model(options.input);
  stop_if_signalled();
  const Selection selection = select_primitives(model, options.selection);
  report.notes = selection.notes;
  for (const std::string& note : model.notes) session.detail(model.path + ": " + note);
  for (const std::string& note : selection.notes) session.note(model.path + ": " + note);
  const std::vector<MeshReport> checks = prepare_model(model, selection, options);
  report.seconds_read = total.seconds();
  std::optional<CheckpointStore> checkpoints;
  if (!options.checkpoint.empty()) checkpoints.emplace(options.checkpoint, session.progress());
  options.order.checkpoints = checkpoints ? &*checkpoints : nullptr;

  std::vector<OrderedPrimitive> ordered;
  FrontierReport frontier = new_frontier_report(options);
  for (std::size_t k = 0; k < selection.primitives.size(); ++k) {
    const std::string& name = model.primitives[selection.primitives[k]].name;
    session.set_subject(selection.primitives.size() == 1
                            ? name
                            : fmt::format("{}/{} {}", k + 1, selection.primitives.size(), name));
    std::optional<SplitReport> split;
    if (options.split.split) split = split_one(model, selection.primitives[k], options, session);
    OrderedOne one = order_one(model, selection.primitives[k], options, session, report.seconds_validate);
    if (!options.frontier.empty()) frontier.primitives.push_back(std::move(one.frontier));
    stop_if_signalled();
    if (options.output.empty()) {
      done.reached.push_back(reached_by(frontier.primitives.back()));
      continue;
    }
    one.report.check = checks[k];
    one.report.split = split;
    done.reached.push_back(reached_by(one.report));
    ordered.push_back(std::move(one.ordered));
    report.primitives.push_back(std::move(one.report));
  }
  session.set_subject("");
  write_frontier(frontier, options.frontier);
  if (!options.frontier.empty()) session.print(to_text(frontier));
  if (options.output.empty()) {
    session.write_json(to_json(frontier));
    if (checkpoints) checkpoints->finish();
    return done;
  }

  begin_stage(session.progress(), "writing", 0);
  const Stopwatch writing;
  const WriteReport written = write_model(model, ordered, options.output, options.write);
  if (checkpoints) checkpoints->finish();
  report.seconds_write = writing.seconds();
  report.disk_bytes = written.order_bytes;
  report.file_bytes = written.file_bytes;
  report.files = written.files;
  report.seconds_total = total.seconds();
  report.peak_rss_bytes = peak_rss_bytes();
  done.report = std::move(report);
  return done;
}

// Throws Error{quality_missed}.
void check_target(const FileOutcome& done, const OrderCommandOptions& options) {
  if (!options.target_given) return;
  check_quality(done.reached, options.order, options.input,
                options.output.empty() ? options.frontier.front() : options.output);
}

void run_single(const OrderCommandOptions& options, Session& session) {
  if (options.run.skip_existing && is_up_to_date({options.input, options.output, {}})) {
    session.note(options.output + ": is there: skipped");
    return;
  }
  try {
    const FileOutcome done = order_file(options, session);
    if (!options.output.empty()) {
      session.print(to_text(done.report));
      session.write_json(to_json(done.report));
    }
    check_target(done, options);
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::interrupted || options.checkpoint.empty()) throw;
    throw Error(ErrorKind::interrupted,
                "interrupted: the same command continues from the records in " + options.checkpoint);
  }
}

void run_order(OrderCommandOptions options, Session& session) {
  check_options(options);
  options.order.partition = parse_partition(options.views);
  options.order.distances = sample_distances(options);
  options.order.seed = session.options().seed;
  options.write.bake_base = !options.no_bake_base;
  if (options.buffers > 0) options.order.min_buffers = options.order.max_buffers = options.buffers;

  const auto options_of = [&](const BatchJob& job) {
    OrderCommandOptions own = options;
    own.input = job.input;
    own.output = job.output;
    own.checkpoint = job.checkpoint;
    return own;
  };
  if (is_into_folder(options.run, options.output)) {
    if (!options.frontier.empty()) {
      throw Error(ErrorKind::bad_argument, "--frontier needs one model, and one file to write: -o OUT.glb");
    }
    if (options.dry_run) {
      for (const BatchJob& job : plan_batch(options.run, options.output)) {
        session.print(fmt::format("{} -> {}\n", job.input, job.output));
        dry_run(options_of(job), session);
      }
      return;
    }
    run_batch(options.run, options.output, session, [&](const BatchJob& job) {
      check_output(job.output);
      const OrderCommandOptions own = options_of(job);
      FileOutcome done = order_file(own, session);
      BatchOutcome outcome{std::move(done.report), {}};
      try {
        check_target(done, own);
      } catch (const Error& error) {
        outcome.missed_quality = error.what();
      }
      return outcome;
    });
    return;
  }
  const OrderCommandOptions own =
      options_of({all_inputs(options.run).front(), options.output, options.run.checkpoint});
  if (!own.output.empty()) check_output(own.output);
  if (own.dry_run) {
    dry_run(own, session);
  } else {
    run_single(own, session);
  }
}

void add_order_options(CLI::App& command, OrderCommandOptions& o) {
  OrderOptions& order = o.order;
  add_choice(command, "--method", order.method,
             {{"budget", OrderMethod::budget}, {"acyclic", OrderMethod::acyclic}},
             "budget: fewest buffers within --max-error (default); acyclic: the paper's")
      ->group("Method");
  command.add_option("--views", o.views, "View cells: S2,2 or P3, T2, R2, ...")
      ->type_name("SPEC")
      ->capture_default_str()
      ->group("Method");
  auto* max_error = command
                        .add_option("--max-error", order.max_error,
                                    "Share of wrong pixels to reach; when given and missed: exit 5")
                        ->check(CLI::Range(0.0, 1.0))
                        ->capture_default_str()
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
    o.target_given = max_error->count() > 0 || min_psnr->count() > 0;
    if (frontier->count() > 0 && max_buffers->count() == 0) o.order.max_buffers = kFrontierBuffers;
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
  command.add_option("--tolerance", order.tolerance, "Ignore overlaps thinner than this, in bounding radii")
      ->check(CLI::Range(0.0, 1.0))
      ->group("Method");

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

void add_file_options(CLI::App& command, OrderCommandOptions& o) {
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

  command.add_option("--cache", o.order.cache_size, "FIFO vertex cache to optimise for; 0: not at all")
      ->check(CLI::Range(0U, 1024U))
      ->capture_default_str()
      ->group("Output");
  add_choice(command, "--cache-method", o.order.cache_method,
             {{"scheduled", CacheMethod::scheduled}, {"tipsify", CacheMethod::tipsify}},
             "scheduled (default), or the paper's tipsify")
      ->group("Output");
  command
      .add_option("--memory", o.order.memory,
                  "Get by with about this much, as in 4GB, by way of a temporary file")
      ->transform(CLI::AsSizeValue(false))
      ->type_name("SIZE")
      ->group("Method");
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

void add_order_command(CLI::App& app, Chosen& chosen) {
  auto options = std::make_shared<OrderCommandOptions>();
  CLI::App* command =
      add_command(app, chosen, "order", "Transparency orders for static meshes: in-depth buffers",
                  "  pellucid order bunny.ply -o bunny.glb --simplify 10000\n"
                  "  pellucid order glass.glb -o out.glb --max-error 0.001 --max-buffers 12\n"
                  "  pellucid order glass.glb --frontier curve.svg --frontier curve.json\n"
                  "  pellucid order glass.glb -o out.gltf --method acyclic --views S2,2 --json stats.json\n"
                  "  pellucid order car.glb -o out.glb --material Windows --split-buffer --encoding meshopt\n"
                  "  pellucid order dragon.ply -o dragon.glb --checkpoint dragon.records\n"
                  "  pellucid order a.glb b.ply c.obj -o ordered/ --json ordered.json",
                  1, [options](Session& session) { run_order(*options, session); });
  add_run_options(*command, options->run);
  command
      ->add_option("-o,--output", options->output,
                   "The file to write: .glb or .gltf; for several models a folder: OUTDIR/")
      ->type_name("FILE");
  add_order_options(*command, *options);
  add_file_options(*command, *options);
}

}  // namespace pellucid::cli
