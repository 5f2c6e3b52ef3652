// What a renderer does on the CPU in every frame, timed: see contender.h.
#include <algorithm>
#include <cmath>

#include "base/platform/platform.h"
#include "baseline/contender.h"
#include "pellucid/runtime/select.h"

namespace pellucid {
namespace {

constexpr std::size_t kTimedViewpoints = 32;
constexpr double kLeastPassSeconds = 2e-3;  // far above the clock's own cost
constexpr double kLeastPassSteps = 20;      // of the clock, which has long ones on Windows
constexpr int kPasses = 5;

// What select.h reads, as a file stores it but for the width of its entries.
struct SelectionTable {
  PellucidOrders orders{};
  std::vector<std::uint32_t> entries;  // one per triangle (S) or corner of one (P)
};

std::shared_ptr<const SelectionTable> selection_table(const OrderSet& set) {
  auto table = std::make_shared<SelectionTable>();
  const ViewPartition partition = make_partition(set.partition);
  if (has_triangle_cells(set.partition)) {
    table->entries = set.cell_orders;
  } else {
    for (const std::uint32_t cell : partition.corner_cells) table->entries.push_back(set.cell_orders[cell]);
  }
  PellucidOrders& orders = table->orders;
  orders.cells = has_triangle_cells(set.partition) ? pellucid_cells_triangles : pellucid_cells_corners;
  orders.level = set.partition.level;
  orders.center[0] = set.sphere.center.x;
  orders.center[1] = set.sphere.center.y;
  orders.center[2] = set.sphere.center.z;
  orders.radius = set.sphere.radius;
  orders.min_distance = set.valid_from;
  orders.max_distance = set.valid_to;
  orders.cell_orders = table->entries.data();
  orders.cell_order_bytes = sizeof(std::uint32_t);
  orders.fallback_order = PELLUCID_NO_ORDER;
  return table;
}

}  // namespace

std::uint64_t cell_table_bytes(const PartitionSpec& partition, std::size_t orders) {
  const std::uint64_t triangles = pellucid_triangle_count(partition.level);
  const std::uint64_t entries = has_triangle_cells(partition) ? triangles : 3 * triangles;
  return entries * (orders <= 255 ? 1 : orders <= 65535 ? 2 : 4);
}

std::function<std::uint64_t(const Viewpoint&)> selection_work(const OrderSet& orders) {
  return [table = selection_table(orders), sphere = orders.sphere](const Viewpoint& view) -> std::uint64_t {
    static constexpr double kIdentity[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    const Eye eye = eye_of(sphere, view);
    const double at[3] = {eye.at.x, eye.at.y, eye.at.z};
    if (eye.w != 0) return pellucid_select_perspective(&table->orders, kIdentity, at);
    const double forward[3] = {-at[0], -at[1], -at[2]};
    return pellucid_select_orthographic(&table->orders, kIdentity, forward);
  };
}

double nanoseconds_per_frame(const std::function<std::uint64_t(const Viewpoint&)>& work,
                             std::span<const Viewpoint> viewpoints) {
  if (!work || viewpoints.empty()) return 0;
  const std::span<const Viewpoint> timed = viewpoints.first(std::min(viewpoints.size(), kTimedViewpoints));
  volatile std::uint64_t sink = 0;  // or the compiler may leave the work out
  const auto pass = [&](std::uint64_t repetitions) {
    const double start = platform::thread_cpu_seconds();
    for (std::uint64_t r = 0; r < repetitions; ++r) {
      for (const Viewpoint& view : timed) sink = sink + work(view);
    }
    return platform::thread_cpu_seconds() - start;
  };
  const double least_pass =
      std::max(kLeastPassSeconds, kLeastPassSteps * platform::thread_cpu_step_seconds());
  std::uint64_t repetitions = 1;
  double least = pass(repetitions);  // also warms the caches
  while (least < least_pass && repetitions < (std::uint64_t{1} << 30U)) {
    repetitions *= 2;
    least = pass(repetitions);
  }
  for (int i = 1; i < kPasses; ++i) least = std::min(least, pass(repetitions));
  return 1e9 * least / static_cast<double>(repetitions * timed.size());
}

}  // namespace pellucid
