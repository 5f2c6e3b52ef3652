// --split: see splitting.h.
#include "splitting.h"

#include <cmath>

#include "pellucid/transparency.h"

namespace pellucid::cli {

void add_split_options(CLI::App& command, SplitChoice& choice) {
  auto* split = command
                    .add_flag("--split", choice.split,
                              "Cut faces that intersect or overlap in cycles: they have no right order")
                    ->group("Meshes");
  command.add_option("--split-limit", choice.limit, "New triangles at most, as a share of the mesh")
      ->check(CLI::Range(0.0, 100.0))
      ->type_name("X")
      ->capture_default_str()
      ->needs(split)
      ->group("Meshes");
}

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

}  // namespace pellucid::cli
