// Cycles of directed graphs: see strong_components.h.
#include "sequencing/strong_components.h"

#include <algorithm>
#include <limits>

#include "base/parallel.h"

namespace pellucid {

bool has_cycle(std::span<const std::uint32_t> offsets, std::span<const std::uint32_t> targets) {
  if (offsets.empty()) return false;
  const std::size_t count = offsets.size() - 1;
  std::vector<std::uint32_t> waiting_for(count, 0);
  for (const std::uint32_t target : targets) ++waiting_for[target];
  std::vector<std::uint32_t> free;
  for (std::uint32_t node = 0; node < count; ++node) {
    if (waiting_for[node] == 0) free.push_back(node);
  }
  std::size_t freed = 0;
  while (!free.empty()) {
    const std::uint32_t node = free.back();
    free.pop_back();
    ++freed;
    for (std::uint32_t i = offsets[node]; i < offsets[node + 1]; ++i) {
      if (--waiting_for[targets[i]] == 0) free.push_back(targets[i]);
    }
  }
  return freed < count;
}

std::vector<std::uint32_t> strong_components(std::span<const std::uint32_t> offsets,
                                             std::span<const std::uint32_t> targets) {
  constexpr std::uint32_t kNew = std::numeric_limits<std::uint32_t>::max();
  const std::size_t count = offsets.empty() ? 0 : offsets.size() - 1;
  std::vector<std::uint32_t> component(count, kNew);
  std::vector<std::uint32_t> index(count, kNew);
  std::vector<std::uint32_t> low(count, 0);
  std::vector<std::uint32_t> open;  // visited, component not known yet
  struct Visit {
    std::uint32_t node, next_edge;
  };
  std::vector<Visit> path;
  std::uint32_t visited = 0;
  std::uint32_t components = 0;
  for (std::uint32_t root = 0; root < count; ++root) {
    if (index[root] != kNew) continue;
    path.push_back({root, offsets[root]});
    while (!path.empty()) {
      const std::uint32_t node = path.back().node;
      if (index[node] == kNew) {
        index[node] = low[node] = visited++;
        open.push_back(node);
      }
      std::uint32_t& edge = path.back().next_edge;
      if (edge < offsets[node + 1]) {
        const std::uint32_t target = targets[edge++];
        if (index[target] == kNew) {
          path.push_back({target, offsets[target]});
        } else if (component[target] == kNew) {
          low[node] = std::min(low[node], index[target]);
        }
        continue;
      }
      path.pop_back();
      if (!path.empty()) low[path.back().node] = std::min(low[path.back().node], low[node]);
      if (low[node] != index[node]) continue;
      while (component[node] == kNew) {
        component[open.back()] = components;
        open.pop_back();
      }
      ++components;
    }
  }
  return component;
}

std::uint32_t count_cyclic_cells(const OcclusionGraph& graph) {
  std::vector<std::uint8_t> cyclic(graph.cells.size(), 0);
  parallel_loop(std::size_t{0}, graph.cells.size(), [&](std::size_t cell) {
    const EdgeRows rows = graph.cells[cell].expanded();
    cyclic[cell] = has_cycle(rows.offsets, rows.backs) ? 1 : 0;
  });
  return static_cast<std::uint32_t>(std::count(cyclic.begin(), cyclic.end(), 1));
}

}  // namespace pellucid
