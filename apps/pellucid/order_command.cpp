// Implements `pellucid order`, which makes transparency orders for the static meshes of a model.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "cleaned.h"
#include "order_options.h"
#include "pellucid/baseline.h"
#include "pellucid/checkpoint.h"
#include "pellucid/report.h"
#include "pellucid/sequencing.h"
#include "pellucid/shading.h"
#include "pellucid/transparency.h"
#include "session.h"

namespace pellucid::cli {
namespace {

// Held-out viewpoints have a seed of their own, because the method must not have been optimised for them.
constexpr std::uint64_t kValidationSeed = 0x5EEDED;
constexpr std::uint32_t kValidationSize = 512;
// Orders of both facings list most triangles twice: 1.45 to 1.6 times the number of triangles on closed
// meshes.
constexpr double kTypicalCopies = 1.6;

Facing facing_of(const Model& model, const Primitive& primitive, FacingChoice choice) {
  if (choice == FacingChoice::single) return Facing::single;
  if (choice == FacingChoice::duplicated) return Facing::duplicated;
  return is_gltf(model) && !primitive.double_sided ? Facing::single : Facing::duplicated;
}

// Cleans and simplifies a primitive of a format other than glTF. An ordered primitive is drawn with blending.
void prepare_mesh(Primitive& primitive, const OrderCommandOptions& options, std::uint32_t target,
                  std::vector<std::string>& notes) {
  clean_for_writing(primitive, options.clean);
  primitive.alpha_mode = AlphaMode::blend;
  if (target > 0 && primitive.mesh.triangles.size() > target) {
    if (!primitive.colors.empty() || !primitive.texcoords.empty())
      notes.push_back(primitive.name + ": simplified without its colours and texture coordinates");
    primitive.colors.clear();
    primitive.texcoords.clear();
    primitive.texture.clear();
    primitive.mesh = simplify(primitive.mesh, target);
    if (!primitive.mesh.triangles.empty()) primitive.mesh.normals = vertex_normals(primitive.mesh);
  }
}

// Checks and prepares the selected primitives. --simplify is the size of the whole model, and every primitive
// gets its share.
std::vector<MeshReport> prepare_model(Model& model, Selection& selection,
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
    prepare_mesh(model.primitives[i], options, static_cast<std::uint32_t>(target), selection.notes);
  }
  return reports;
}

// Measures the error from held-out viewpoints and stores it in the report.
void validate_orders(const Mesh& mesh, const OrderSet& orders, std::uint32_t viewpoints, double alpha,
                     Session& session, PrimitiveOrderReport& report) {
  MeasureOptions measure;
  measure.viewpoints = viewpoints;
  measure.size = kValidationSize;
  measure.seed = kValidationSeed ^ session.options().seed;
  measure.facing = orders.facing;
  measure.shading.alpha = alpha;
  // The range of the paper is 2 to 5 radii. It is limited to the range that the orders were made for.
  measure.min_distance = std::max(2.0, orders.valid_from);
  measure.max_distance = std::max(measure.min_distance, std::min(5.0, orders.valid_to));
  measure.progress = session.progress();
  std::vector<DrawingMethod> methods{
      {"orders", [&](const Viewpoint& viewpoint) { return ranks_from(mesh, orders, viewpoint); }}};
  // If faces intersect or overlap in cycles, the error of the best possible order is measured, too.
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

// Replaces the mesh of the primitive by its pieces if there is something to cut. Returns nothing, with a
// note, if the triangles of the primitive may not change.
std::optional<SplitReport> split_primitive(Model& model, std::uint32_t index, const SplitChoice& choice,
                                           const CleanOptions& cleaning, const OrderOptions& order,
                                           Session& session) {
  Primitive& primitive = model.primitives[index];
  if (!triangles_may_change(model, index)) {
    session.note(model.path + ": " + primitive.name +
                 ": an extension numbers its triangles, they are left as they are");
    return std::nullopt;
  }
  const Mesh mesh = clean(primitive.mesh, cleaning, model.path + ": " + primitive.name).mesh;
  if (mesh.triangles.empty()) return std::nullopt;
  CycleOptions options;
  options.distances = order.distances;
  options.facing = order.facing;
  options.max_new_triangles =
      static_cast<std::uint64_t>(std::ceil(choice.limit * static_cast<double>(mesh.triangles.size())));
  options.progress = session.progress();
  SplitResult result = split_unordered(mesh, options);

  SplitReport report;
  report.intersecting_pairs = result.intersecting_pairs;
  report.pairs_left = result.pairs_left;
  report.viewpoints = result.viewpoints;
  report.cyclic_before = result.cyclic_before;
  report.cyclic_left = result.cyclic_left;
  report.added_by_intersections = result.added_by_intersections;
  report.added_by_cycles = result.added_by_cycles;
  report.limit_met = !result.split.complete;
  if (result.split.mesh.triangles != mesh.triangles) {
    primitive.mesh = std::move(result.split.mesh);
    primitive.new_vertices = std::move(result.split.new_vertices);
    primitive.orders.reset();
  }
  return report;
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
  PrimitiveFrontier frontier;  // for --frontier; without -o there is no other result
};

OrderedOne order_one(const Model& model, std::uint32_t index, const OrderCommandOptions& options,
                     Session& session, double& seconds_validate) {
  const Primitive& primitive = model.primitives[index];
  const CleanMesh clean_mesh =
      clean_to_order(primitive.mesh, options.clean, model.path + ": " + primitive.name);
  const Mesh& mesh = clean_mesh.mesh;
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
  // A simple mesh has nothing that could be wrong.
  if (options.check_views > 0 && !result.statistics.simple) {
    const Stopwatch watch;
    validate_orders(mesh, result.orders, options.check_views, image_alpha(order), session, report);
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
                        (facing == Facing::duplicated ? kTypicalCopies : 1.0);
    const std::uint64_t bytes =
        static_cast<std::uint64_t>(list) * 3 * bytes_per_index(primitive.mesh.positions.size());
    table.add_row({primitive.name, primitive.material_name.empty() ? "(none)" : primitive.material_name,
                   format_count(primitive.mesh.triangles.size()),
                   facing == Facing::single ? "single" : "duplicated", format_bytes(bytes),
                   most == 0 ? "-" : format_bytes(most * bytes)});
  }
  session.print(table.to_string());
  session.print("dry run: nothing was written; sizes are estimates\n");
}

void write_frontier(const FrontierReport& report, const std::vector<std::string>& paths) {
  for (const std::string& path : paths) {
    write_file_atomically(path, is_plot(path) ? frontier_svg(report) : to_json(report));
  }
}

FrontierReport new_frontier_report(const OrderCommandOptions& options) {
  FrontierReport report;
  report.input = options.input;
  report.views = to_string(options.order.partition);
  report.distances = options.order.distances;
  report.seed = options.order.seed;
  report.alpha = options.order.alpha;
  report.image_alpha = image_alpha(options.order);
  report.max_error = options.order.max_error;
  report.min_psnr = options.order.min_psnr;
  report.least_frame_time = options.order.least_frame_time;
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
  report.image_alpha = image_alpha(options.order);
  report.distances = options.order.distances;
  return report;
}

void dry_run(const OrderCommandOptions& options, Session& session) {
  const Model model = open_model(options.input, session);
  if (!options.in_batch) refuse_for_model(options, model);
  const Selection selection = select_primitives(model, options.selection);
  for (const std::string& note : selection.notes) session.note(model.path + ": " + note);
  print_plan(model, selection, options, session);
}

// ----------------------------------------------------------------------------------- was the target reached?

// The error of one primitive and the number of its buffers. It is the error that the method measured itself,
// or else that over the held-out viewpoints. It is negative if neither was measured.
struct Reached {
  std::string name;
  double ipr = -1, psnr = -1;
  std::size_t buffers = 0;
};

bool meets(const Reached& reached, const OrderOptions& target) {
  if (target.min_psnr) return reached.psnr < 0 || reached.psnr >= *target.min_psnr;
  return reached.ipr <= target.max_error;
}

std::string shortfall(const Reached& reached, const OrderOptions& target) {
  if (target.min_psnr) {
    return fmt::format("PSNR {:.2f} dB with {} buffers, asked for {:g} dB", reached.psnr, reached.buffers,
                       *target.min_psnr);
  }
  return fmt::format("wrong pixels {} with {} buffers, asked for {}", format_percent(reached.ipr),
                     reached.buffers, format_percent(target.max_error));
}

Reached reached_by(const PrimitiveOrderReport& report) {
  Reached reached{report.name, report.statistics.measured_error, report.statistics.measured_psnr,
                  report.buffers.size()};
  if (reached.ipr < 0 && report.error) reached.ipr = report.error->ipr_mean;
  if (reached.psnr < 0 && report.error) reached.psnr = report.error->psnr_mean;
  return reached;
}

Reached reached_by(const PrimitiveFrontier& primitive) {
  const FrontierPoint& point = primitive.frontier.points[primitive.frontier.chosen - 1];
  return {primitive.name, point.ipr, point.psnr, point.buffers};
}

// Throws Error{quality_missed} for the first primitive that missed the target. `written` is the file that was
// written all the same.
void check_quality(const std::vector<Reached>& all, const OrderOptions& target, const std::string& input,
                   const std::string& written) {
  for (const Reached& reached : all) {
    if (meets(reached, target)) continue;
    throw Error(ErrorKind::quality_missed,
                fmt::format("{}: {}: {} (more --max-buffers may help); {} was written all the same", input,
                            reached.name, shortfall(reached, target), written));
  }
}

// ------------------------------------------------------------------------------------ one model, or many

struct FileOutcome {
  OrderReport report;  // empty without -o
  std::vector<Reached> reached;
};

FileOutcome order_file(OrderCommandOptions options, Session& session) {
  FileOutcome done;
  const Stopwatch total;
  OrderReport report = new_report(options);
  begin_stage(session.progress(), "reading", 0);
  Model model = open_model(options.input, session);
  stop_if_signalled();
  if (!options.in_batch) refuse_for_model(options, model);
  Selection selection = select_primitives(model, options.selection);
  const std::vector<MeshReport> checks = prepare_model(model, selection, options);
  for (const std::string& note : selection.notes) session.note(model.path + ": " + note);
  report.notes = selection.notes;
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
  for (const std::string& note : written.notes) session.note(note);
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

// Throws Error{quality_missed} if the target was missed.
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
  settle_options(options);
  options.order.seed = session.options().seed;
  options.clean.strict = session.options().strict;

  const auto options_of = [&](const BatchJob& job) {
    OrderCommandOptions own = options;
    own.input = job.input;
    own.output = job.output;
    own.checkpoint = job.checkpoint;
    return own;
  };
  if (is_into_folder(options.run, options.output)) {
    options.in_batch = true;
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
  session.check_json();
  if (own.dry_run) {
    dry_run(own, session);
  } else {
    run_single(own, session);
  }
}

}  // namespace

void add_order_command(CLI::App& app, Chosen& chosen) {
  auto options = std::make_shared<OrderCommandOptions>();
  CLI::App* command = add_command(
      app, chosen, "order", "Compute transparency orders (in-depth buffers) for the static meshes of a model",
      "  pellucid order bunny.ply -o bunny.glb --simplify 10000\n"
      "  pellucid order glass.glb -o out.glb --max-error 0.001 --max-buffers 12\n"
      "  pellucid order glass.glb --frontier curve.svg --frontier curve.json\n"
      "  pellucid order glass.glb -o out.gltf --method acyclic --partition S2,2 --json stats.json\n"
      "  pellucid order car.glb -o out.glb --material Windows --split-buffer --encoding meshopt\n"
      "  pellucid order dragon.ply -o dragon.glb --checkpoint dragon.records\n"
      "  pellucid order a.glb b.ply c.obj -o ordered/ --json ordered.json",
      1, [options](Session& session) { run_order(*options, session); });
  add_order_options(*command, *options);
}

}  // namespace pellucid::cli
