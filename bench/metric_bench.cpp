// Vertex-cache simulation per triangle, and one measured frame (raster, ranks, wrong pixels) of random
// triangles.
#include <benchmark/benchmark.h>

#include <numeric>

#include "pellucid/metric.h"
#include "pellucid/sequencing.h"

namespace pellucid {
namespace {

Mesh random_soup(std::uint32_t triangles, double size) {
  Random random(1);
  Mesh mesh;
  for (std::uint32_t i = 0; i < triangles; ++i) {
    const Vec3d middle = random.direction() * random.uniform(0.5, 1.0);
    for (int k = 0; k < 3; ++k) mesh.positions.push_back(to_float(middle + random.direction() * size));
    mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  return mesh;
}

void BM_SimulateVertexCache(benchmark::State& state) {
  constexpr std::uint32_t kVertices = 50000;
  Random random(2);
  std::vector<std::uint32_t> indices;
  for (std::uint32_t i = 0; i < 6 * kVertices; ++i) {
    indices.push_back(static_cast<std::uint32_t>((i / 6 + random.below(30)) % kVertices));
  }
  const auto model = state.range(0) == 0 ? CacheModel::fifo : CacheModel::lru;
  for (auto _ : state) benchmark::DoNotOptimize(simulate_vertex_cache(indices, kVertices, model, 20).misses);
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations()) *
                          static_cast<std::int64_t>(indices.size() / 3));
}
BENCHMARK(BM_SimulateVertexCache)->ArgName("lru")->Arg(0)->Arg(1)->Unit(benchmark::kMicrosecond);

// File order: nearly every pixel is wrong and has to be blended twice.
void BM_MeasureFrame(benchmark::State& state) {
  const ThreadLimit one_thread(1);
  const Mesh mesh = random_soup(10000, 0.03);
  std::vector<std::uint32_t> ranks(2 * mesh.triangles.size());
  std::iota(ranks.begin(), ranks.end(), 0U);
  const std::vector<DrawingMethod> methods{{"file", [&](const Viewpoint&) { return ranks; }}};
  MeasureOptions options;
  options.viewpoints = 4;
  options.size = static_cast<std::uint32_t>(state.range(0));
  for (auto _ : state) benchmark::DoNotOptimize(measure_order_quality(mesh, methods, options)[0].ipr_mean);
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations()) * options.viewpoints);
}
BENCHMARK(BM_MeasureFrame)->ArgName("size")->Arg(512)->Arg(1024)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace pellucid
