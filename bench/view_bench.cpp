// Measures the time of a run-time selection with the descent of each level and with the (theta, phi) table of
// the paper, and the time to make a partition.
#include <benchmark/benchmark.h>

#include <array>
#include <vector>

#include "pellucid/runtime/select.h"
#include "pellucid/view.h"

namespace {

std::vector<std::array<double, 3>> random_directions() {
  pellucid::Random random(1);
  std::vector<std::array<double, 3>> directions;
  for (int i = 0; i < 4096; ++i) {
    const pellucid::Vec3d d = random.direction();
    directions.push_back({d.x, d.y, d.z});
  }
  return directions;
}

void BM_descent(benchmark::State& state) {
  const auto directions = random_directions();
  const auto level = static_cast<std::uint32_t>(state.range(0));
  std::size_t i = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(pellucid_find_triangle(level, directions[i].data()));
    i = (i + 1) % directions.size();
  }
}
BENCHMARK(BM_descent)->ArgName("level")->DenseRange(0, 8);

void BM_table(benchmark::State& state) {
  const auto directions = random_directions();
  const auto level = static_cast<std::uint32_t>(state.range(0));
  const std::uint32_t steps = 4U << level;
  std::vector<PellucidTableCell> cells(pellucid_triangle_count(level));
  std::vector<std::uint32_t> grid(std::size_t{steps} * steps * 2);
  const PellucidTable table{level, steps, 2 * steps, cells.data(), grid.data()};
  pellucid_table_build(&table);
  std::size_t i = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(pellucid_table_find(&table, directions[i].data()));
    i = (i + 1) % directions.size();
  }
}
BENCHMARK(BM_table)->ArgName("level")->DenseRange(0, 4);

void BM_corner(benchmark::State& state) {
  const auto directions = random_directions();
  std::size_t i = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(pellucid_find_corner(2, directions[i].data()));
    i = (i + 1) % directions.size();
  }
}
BENCHMARK(BM_corner);

void BM_make_partition(benchmark::State& state) {
  const auto level = static_cast<std::uint32_t>(state.range(0));
  for (auto _ : state) {
    benchmark::DoNotOptimize(
        pellucid::make_partition({pellucid::PartitionKind::sampled_triangles, level, 2}));
  }
}
BENCHMARK(BM_make_partition)->ArgName("level")->DenseRange(0, 3)->Unit(benchmark::kMillisecond);

}  // namespace
