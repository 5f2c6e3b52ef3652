// One sequence of all triangles for every view: see base_sequence.h.
#include "transparency/base_sequence.h"

#include <meshoptimizer.h>

#include <algorithm>
#include <numeric>

#include "sequencing/linear_order.h"
#include "transparency/cluster/budget.h"
#include "transparency/upsample/upsample.h"

namespace pellucid {
namespace {

// Triangles: long enough to keep the cache warm, short enough to follow the order.
constexpr std::size_t kRun = 32;

// The edges between faces as stored, without the flipped twins.
EdgeRows stored_facings_only(const EdgeRows& edges) {
  EdgeRows stored;
  stored.offsets.push_back(0);
  for (NodeId front = 0; front < edges.node_count(); ++front) {
    for (std::uint32_t i = edges.offsets[front]; !is_flipped(front) && i < edges.offsets[front + 1]; ++i) {
      if (is_flipped(edges.backs[i])) continue;
      stored.backs.push_back(edges.backs[i]);
      stored.weights.push_back(edges.weights[i]);
    }
    stored.offsets.push_back(static_cast<std::uint32_t>(stored.backs.size()));
  }
  return stored;
}

std::vector<std::uint32_t> single_order(const OrderProblem& problem) {
  std::vector<std::uint32_t> all_cells(problem.partition.cell_count());
  std::iota(all_cells.begin(), all_cells.end(), 0U);
  std::vector<std::uint32_t> ranks =
      ranks_by_key(depth_keys(*problem.mesh, problem.sphere, problem.partition, all_cells));
  sift(net_preferences(stored_facings_only(sum_cells(problem.graph, all_cells))), {}, ranks);
  return ranks;
}

}  // namespace

std::vector<std::uint32_t> cache_positions(const Mesh& mesh) {
  std::vector<std::uint32_t> indices;
  indices.reserve(3 * mesh.triangles.size());
  for (const Triangle& t : mesh.triangles) indices.insert(indices.end(), t.begin(), t.end());
  // The optimiser permutes whole triangles but may rotate them: find them again by sorted corners.
  std::vector<std::uint32_t> optimized(indices.size());
  meshopt_optimizeVertexCache(optimized.data(), indices.data(), indices.size(), mesh.positions.size());
  const auto key = [](const std::uint32_t* c) {
    std::array<std::uint32_t, 3> k{c[0], c[1], c[2]};
    std::rotate(k.begin(), std::min_element(k.begin(), k.end()), k.end());
    return k;
  };
  const auto sorted = [&](const std::vector<std::uint32_t>& list) {
    std::vector<std::uint32_t> order(list.size() / 3);
    std::iota(order.begin(), order.end(), 0U);
    std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
      const auto ka = key(&list[3 * std::size_t{a}]);
      const auto kb = key(&list[3 * std::size_t{b}]);
      return ka != kb ? ka < kb : a < b;
    });
    return order;
  };
  const std::vector<std::uint32_t> before = sorted(indices);
  const std::vector<std::uint32_t> after = sorted(optimized);
  std::vector<std::uint32_t> positions(mesh.triangles.size());
  for (std::size_t i = 0; i < positions.size(); ++i) positions[before[i]] = after[i];
  return positions;
}

std::vector<std::uint32_t> base_sequence(const Mesh& mesh, const OrderProblem& coarse) {
  const std::vector<std::uint32_t> ranks = single_order(coarse);
  std::vector<NodeId> parents(2 * mesh.triangles.size());
  if (coarse.mesh == &mesh) {
    std::iota(parents.begin(), parents.end(), 0U);
  } else {
    parents = nearest_coarse_nodes(mesh, *coarse.mesh);
  }
  const std::vector<std::uint32_t> positions = cache_positions(mesh);
  std::vector<std::uint32_t> cache_order(mesh.triangles.size());
  for (std::uint32_t t = 0; t < cache_order.size(); ++t) cache_order[positions[t]] = t;

  struct Run {
    double rank;
    std::size_t begin, end;
  };
  std::vector<Run> runs;
  for (std::size_t begin = 0; begin < cache_order.size(); begin += kRun) {
    Run run{0, begin, std::min(begin + kRun, cache_order.size())};
    for (std::size_t i = run.begin; i < run.end; ++i)
      run.rank += ranks[parents[2 * std::size_t{cache_order[i]}]];
    run.rank /= static_cast<double>(run.end - run.begin);
    runs.push_back(run);
  }
  std::stable_sort(runs.begin(), runs.end(), [](const Run& a, const Run& b) { return a.rank > b.rank; });
  std::vector<std::uint32_t> sequence;
  sequence.reserve(cache_order.size());
  for (const Run& run : runs) {
    sequence.insert(sequence.end(), cache_order.begin() + static_cast<std::ptrdiff_t>(run.begin),
                    cache_order.begin() + static_cast<std::ptrdiff_t>(run.end));
  }
  return sequence;
}

}  // namespace pellucid
