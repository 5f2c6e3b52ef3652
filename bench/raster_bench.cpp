// Measures the fragments per second of the CPU raster on one thread, by number of triangles and image size.
// The mesh is a wrinkled sphere with about as many layers as the bunny, so that no file is needed.
#include <benchmark/benchmark.h>

#include <cmath>

#include "pellucid/raster.h"

namespace pellucid {
namespace {

// Returns a sphere of 4 * segments^2 triangles with a varying radius.
Mesh wrinkled_sphere(std::uint32_t segments) {
  constexpr double kPi = 3.14159265358979323846;
  Mesh mesh;
  const std::uint32_t columns = 2 * segments;
  for (std::uint32_t i = 0; i <= segments; ++i) {
    for (std::uint32_t j = 0; j < columns; ++j) {
      const double theta = kPi * i / segments;
      const double phi = 2 * kPi * j / columns;
      const double r = 0.8 + 0.2 * std::sin(5 * theta) * std::sin(7 * phi);
      mesh.positions.push_back(to_float(Vec3d{r * std::sin(theta) * std::cos(phi), r * std::cos(theta),
                                              -r * std::sin(theta) * std::sin(phi)}));
    }
  }
  for (std::uint32_t i = 0; i < segments; ++i) {
    for (std::uint32_t j = 0; j < columns; ++j) {
      const std::uint32_t right = (j + 1) % columns;
      const std::uint32_t upper = i * columns;
      const std::uint32_t lower = upper + columns;
      mesh.triangles.push_back({upper + j, lower + j, lower + right});
      mesh.triangles.push_back({upper + j, lower + right, upper + right});
    }
  }
  return mesh;
}

void BM_Rasterize(benchmark::State& state) {
  const ThreadLimit one_thread(1);
  const Mesh mesh = wrinkled_sphere(static_cast<std::uint32_t>(state.range(0)));
  const auto size = static_cast<std::uint32_t>(state.range(1));
  const Camera camera =
      look_at_sphere(bounding_sphere(mesh), {normalized(Vec3d{1, 0.5, 0.7}), 3}, size, size);
  FragmentBuffer buffer;
  for (auto _ : state) {
    rasterize(mesh, camera, {}, buffer);
    benchmark::DoNotOptimize(buffer.fragments.data());
  }
  const auto frames = static_cast<std::int64_t>(state.iterations());
  state.SetItemsProcessed(frames * static_cast<std::int64_t>(buffer.fragments.size()));
  state.counters["triangles"] = static_cast<double>(mesh.triangles.size());
  state.counters["fragments"] = static_cast<double>(buffer.fragments.size());
}
BENCHMARK(BM_Rasterize)
    ->ArgNames({"segments", "size"})
    ->Args({50, 512})
    ->Args({50, 1024})
    ->Args({160, 1024})
    ->Args({466, 1024})
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace pellucid
