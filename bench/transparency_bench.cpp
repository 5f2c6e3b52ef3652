// The parts of ordering that take its time: edges of one viewpoint, pair search, sifting, sequences,
// selection. The mesh is the torus knot sample, simplified to 10,000 triangles: many layers, and no file is
// needed.
#include <benchmark/benchmark.h>

#include "pellucid/sequencing.h"
#include "pellucid/transparency.h"
#include "sequencing/cache_order.h"
#include "sequencing/fifo_cache.h"
#include "sequencing/linear_order.h"
#include "transparency/cluster/clustering.h"
#include "transparency/graph/occlusion_graph.h"
#include "transparency/graph/viewpoint_edges.h"

namespace pellucid {
namespace {

Mesh torus_knot(std::uint32_t triangles) {
  const Mesh mesh = make_sample("torus-knot", 4)[0].mesh;
  return simplify(mesh, triangles);
}

OcclusionScene scene_of(const Mesh& mesh) {
  const BoundingSphere sphere = bounding_sphere(mesh);
  return {mesh, sphere, unit_positions(mesh, sphere)};
}

const Viewpoint kViewpoint{normalized(Vec3d{1, 0.5, 0.7}), 3};

void BM_FindEdgesExactly(benchmark::State& state) {
  const ThreadLimit one_thread(1);
  const Mesh mesh = torus_knot(static_cast<std::uint32_t>(state.range(0)));
  const OcclusionScene scene = scene_of(mesh);
  OcclusionScratch scratch;
  ViewpointEdges edges;
  for (auto _ : state) {
    find_edges_exactly(scene, kViewpoint, scratch, edges);
    benchmark::DoNotOptimize(edges.backs.data());
  }
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations()) *
                          static_cast<std::int64_t>(edges.backs.size()));
  state.counters["triangles"] = static_cast<double>(mesh.triangles.size());
  state.counters["pairs"] = static_cast<double>(scratch.pairs.size());
  state.counters["edges"] = static_cast<double>(edges.backs.size());
}
BENCHMARK(BM_FindEdgesExactly)->ArgName("triangles")->Arg(1000)->Arg(10000)->Unit(benchmark::kMillisecond);

void BM_PairSearch(benchmark::State& state) {
  const Mesh mesh = torus_knot(static_cast<std::uint32_t>(state.range(0)));
  const OcclusionScene scene = scene_of(mesh);
  ScreenTriangles screen;
  project_triangles(scene.positions, mesh.triangles, kViewpoint, false, screen);
  PairSearch search;
  std::vector<CandidatePair> pairs;
  for (auto _ : state) {
    search.find(screen.bounds, pairs);
    benchmark::DoNotOptimize(pairs.data());
  }
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations()) *
                          static_cast<std::int64_t>(pairs.size()));
  state.counters["pairs"] = static_cast<double>(pairs.size());
}
BENCHMARK(BM_PairSearch)->ArgName("triangles")->Arg(1000)->Arg(10000)->Unit(benchmark::kMillisecond);

// One order for all views of a partition, from the order of the file.
void BM_Sift(benchmark::State& state) {
  const Mesh mesh = torus_knot(static_cast<std::uint32_t>(state.range(0)));
  const ViewPartition partition = make_partition({PartitionKind::sampled_triangles, 0, 1});
  GraphOptions options;
  options.distances = {3};
  const OcclusionGraph graph = build_occlusion_graph(mesh, bounding_sphere(mesh), partition, options);
  std::vector<std::uint32_t> start(graph.node_count);
  for (std::uint32_t node = 0; node < start.size(); ++node) start[node] = node;
  const std::vector<std::uint32_t> cells{0, 1, 2, 3, 4};
  const PairPreferences preferences = net_preferences(sum_cells(graph, cells));
  double left = 0;
  for (auto _ : state) {
    std::vector<std::uint32_t> ranks = start;
    left = sift(preferences, {}, ranks);
    benchmark::DoNotOptimize(ranks.data());
  }
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations()) *
                          static_cast<std::int64_t>(preferences.neighbors.size() / 2));
  state.counters["pairs"] = static_cast<double>(preferences.neighbors.size()) / 2;
  state.counters["violated share"] = left / violated_weight(preferences, start);
}
BENCHMARK(BM_Sift)->ArgName("triangles")->Arg(1000)->Arg(10000)->Unit(benchmark::kMillisecond);

// Vertex-cache sequences of all facings, seen from five cells.
void BM_Sequence(benchmark::State& state) {
  const ThreadLimit one_thread(1);
  const Mesh mesh = torus_knot(static_cast<std::uint32_t>(state.range(0)));
  const ViewPartition partition = make_partition({PartitionKind::sampled_triangles, 0, 1});
  GraphOptions options;
  options.distances = {3};
  const BoundingSphere sphere = bounding_sphere(mesh);
  const OcclusionGraph graph = build_occlusion_graph(mesh, sphere, partition, options);
  const std::vector<std::uint32_t> cells{0, 1, 2, 3, 4};
  const EdgeRows edges = sum_cells(graph, cells);
  std::vector<std::uint32_t> ranks = ranks_by_key(depth_keys(mesh, sphere, partition, cells));
  sift(net_preferences(edges), {}, ranks);
  const std::vector<std::uint8_t> drawn(graph.node_count, 1);
  CacheOrderOptions sequence_options;
  sequence_options.method = state.range(1) == 0 ? CacheMethod::scheduled : CacheMethod::tipsify;
  sequence_options.least_binding = 1e-6F;
  sequence_options.slack = 5e-4;
  NodeSequence sequence;
  for (auto _ : state) {
    sequence = cache_aware_order(mesh, edges, ranks, drawn, sequence_options);
    benchmark::DoNotOptimize(sequence.data());
  }
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations()) *
                          static_cast<std::int64_t>(sequence.size()));
  state.counters["edges"] = static_cast<double>(edges.edge_count());
  state.counters["ACMR"] =
      static_cast<double>(fifo_misses(mesh, sequence, 20)) / static_cast<double>(sequence.size());
}
BENCHMARK(BM_Sequence)
    ->ArgNames({"triangles", "tipsify"})
    ->Args({1000, 0})
    ->Args({10000, 0})
    ->Args({10000, 1})
    ->Unit(benchmark::kMillisecond);

void BM_SelectOrder(benchmark::State& state) {
  OrderSet set;
  set.partition = parse_partition("S2,2");
  set.cell_orders.assign(make_partition(set.partition).cell_count(), 0);
  Random random(1);
  std::vector<Vec3d> directions(1024);
  for (Vec3d& direction : directions) direction = random.direction();
  std::size_t i = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(select_order(set, directions[i]));
    i = (i + 1) % directions.size();
  }
}
BENCHMARK(BM_SelectOrder);

}  // namespace
}  // namespace pellucid
