// Implements the choice of constraints and the combination of the methods of cache_order.h.
#include "sequencing/cache_order.h"

#include <algorithm>
#include <array>
#include <bit>
#include <numeric>

#include "sequencing/fifo_cache.h"

namespace pellucid {
namespace {

// Nodes whose reachability is stored at a time, which bounds the memory of the transitive reduction.
constexpr std::uint32_t kColumns = 8192;
constexpr std::uint32_t kWords = kColumns / 64;
// The ratio between consecutive weights below which constraints are lifted.
constexpr float kNextLeast = 2;
// The next weight is tried only if less than this share of the slack is used. Otherwise it would hardly
// succeed.
constexpr double kSlackToGoOn = 0.5;

// Constraints between positions in an order instead of nodes.
class PositionRows {
 public:
  PositionRows(const OrderConstraints& constraints, const NodeSequence& order)
      : constraints_(constraints), order_(order), positions_(constraints.offsets.size() - 1, 0) {
    for (std::uint32_t i = 0; i < order.size(); ++i) positions_[order[i]] = i;
  }
  // Sets a bit for every follower of a position within [begin, begin + kColumns).
  void mark(std::uint32_t position, std::uint32_t begin, std::span<std::uint64_t> bits) const {
    for (const NodeId follower : constraints_.followers_of(order_[position])) {
      const std::uint32_t column = positions_[follower] - begin;
      if (column < kColumns) bits[column / 64] |= std::uint64_t{1} << (column % 64);
    }
  }

 private:
  const OrderConstraints& constraints_;
  const NodeSequence& order_;
  std::vector<std::uint32_t> positions_;
};

}  // namespace

VertexNodes::VertexNodes(const Mesh& mesh, std::span<const std::uint8_t> drawn) {
  offsets_.assign(mesh.positions.size() + 1, 0);
  for (NodeId node = 0; node < drawn.size(); ++node) {
    if (drawn[node] == 0) continue;
    for (const std::uint32_t vertex : mesh.triangles[triangle_of(node)]) ++offsets_[vertex + 1];
  }
  std::partial_sum(offsets_.begin(), offsets_.end(), offsets_.begin());
  nodes_.resize(offsets_.back());
  std::vector<std::uint32_t> cursor(offsets_.begin(), offsets_.end() - 1);
  for (NodeId node = 0; node < drawn.size(); ++node) {
    if (drawn[node] == 0) continue;
    for (const std::uint32_t vertex : mesh.triangles[triangle_of(node)]) nodes_[cursor[vertex]++] = node;
  }
}

OrderConstraints agreeing_edges(const EdgeRows& edges, std::span<const std::uint32_t> ranks,
                                std::span<const std::uint8_t> drawn, float least) {
  OrderConstraints constraints;
  constraints.offsets.reserve(edges.offsets.size());
  constraints.followers.reserve(edges.edge_count());
  constraints.offsets.push_back(0);
  for (NodeId front = 0; front < edges.node_count(); ++front) {
    for (std::uint32_t i = edges.offsets[front]; drawn[front] != 0 && i < edges.offsets[front + 1]; ++i) {
      const NodeId back = edges.backs[i];
      if (drawn[back] != 0 && edges.weights[i] >= least && ranks[front] < ranks[back]) {
        constraints.followers.push_back(back);
      }
    }
    constraints.offsets.push_back(static_cast<std::uint32_t>(constraints.followers.size()));
  }
  return constraints;
}

OrderConstraints without_implied(const OrderConstraints& constraints, std::span<const std::uint32_t> ranks,
                                 std::span<const std::uint8_t> drawn) {
  // Process a block of columns, which are followers by position, at a time. Visit the nodes from last to
  // first. A follower is implied if a nearer follower reaches it.
  const NodeSequence order = order_by_rank(ranks, drawn);
  const auto count = static_cast<std::uint32_t>(order.size());
  const PositionRows rows(constraints, order);
  std::vector<std::vector<std::uint32_t>> kept(count);
  std::vector<std::uint64_t> reached;
  std::array<std::uint64_t, kWords> marked{};
  for (std::uint32_t begin = 0; begin < count; begin += kColumns) {
    const std::uint32_t end = std::min(begin + kColumns, count);
    reached.assign(std::size_t{end} * kWords, 0);
    for (std::uint32_t i = end; i-- > 0;) {
      std::uint64_t* const own = &reached[std::size_t{i} * kWords];
      const auto reach_through = [&](std::uint32_t follower) {
        const std::uint64_t* const more = &reached[std::size_t{follower} * kWords];
        for (std::uint32_t w = 0; w < kWords; ++w) own[w] |= more[w];
      };
      for (const std::uint32_t follower : kept[i]) reach_through(follower);
      marked.fill(0);
      rows.mark(i, begin, marked);
      for (std::uint32_t w = 0; w < kWords; ++w) {
        while ((marked[w] & ~own[w]) != 0) {
          const auto bit = static_cast<std::uint32_t>(std::countr_zero(marked[w] & ~own[w]));
          const std::uint32_t follower = begin + 64 * w + bit;
          kept[i].push_back(follower);
          reach_through(follower);
          own[w] |= std::uint64_t{1} << bit;
        }
      }
    }
  }
  OrderConstraints reduced;
  reduced.offsets.assign(constraints.offsets.size(), 0);
  for (std::uint32_t i = 0; i < count; ++i) {
    reduced.offsets[order[i] + 1] = static_cast<std::uint32_t>(kept[i].size());
  }
  for (std::size_t i = 1; i < reduced.offsets.size(); ++i) reduced.offsets[i] += reduced.offsets[i - 1];
  reduced.followers.resize(reduced.offsets.back());
  for (std::uint32_t i = 0; i < count; ++i) {
    std::transform(kept[i].begin(), kept[i].end(), reduced.followers.begin() + reduced.offsets[order[i]],
                   [&](std::uint32_t position) { return order[position]; });
  }
  return reduced;
}

NodeSequence order_by_rank(std::span<const std::uint32_t> ranks, std::span<const std::uint8_t> drawn) {
  NodeSequence order;
  for (NodeId node = 0; node < drawn.size(); ++node) {
    if (drawn[node] != 0) order.push_back(node);
  }
  std::sort(order.begin(), order.end(), [&](NodeId a, NodeId b) { return ranks[a] < ranks[b]; });
  return order;
}

double violated_weight_of(const EdgeRows& edges, std::span<const std::uint32_t> ranks,
                          std::span<const std::uint8_t> drawn) {
  double sum = 0;
  for (NodeId front = 0; front < edges.node_count(); ++front) {
    for (std::uint32_t i = edges.offsets[front]; drawn[front] != 0 && i < edges.offsets[front + 1]; ++i) {
      const NodeId back = edges.backs[i];
      if (drawn[back] != 0 && ranks[back] < ranks[front]) sum += static_cast<double>(edges.weights[i]);
    }
  }
  return sum;
}

NodeSequence cache_aware_order(const Mesh& mesh, const EdgeRows& edges, std::span<const std::uint32_t> ranks,
                               std::span<const std::uint8_t> drawn, const CacheOrderOptions& options) {
  const std::uint64_t triangles = mesh.triangles.size();
  const NodeSequence by_rank = order_by_rank(ranks, drawn);
  const auto constraints_of = [&](std::span<const std::uint32_t> agreeing, float least) {
    stop_if_requested(options.progress);
    return without_implied(agreeing_edges(edges, agreeing, drawn, least), agreeing, drawn);
  };
  // Returns the order of the chosen method, or the order by rank if that has fewer misses.
  const auto first_order = [&](const OrderConstraints& constraints) {
    const auto method = options.method == CacheMethod::tipsify ? tipsify : list_schedule;
    NodeSequence order = method(mesh, constraints, ranks, drawn, options.cache_size);
    const bool better =
        fifo_misses(mesh, order, options.cache_size) <= fifo_misses(mesh, by_rank, options.cache_size);
    return better ? order : by_rank;
  };
  if (options.method == CacheMethod::tipsify) {
    return first_order(constraints_of(ranks, options.least_binding));
  }

  // Lift the lightest constraints and then heavier ones, until this violates more weight than the slack
  // permits.
  const double violated_by_ranks = violated_weight_of(edges, ranks, drawn);
  NodeSequence order;
  double used = 0;
  for (float least = options.least_binding; least > 0 && used < kSlackToGoOn * options.slack;
       least *= kNextLeast) {
    const bool first = order.empty();
    const OrderConstraints binding = constraints_of(
        first ? std::vector<std::uint32_t>(ranks.begin(), ranks.end()) : ranks_of(order, triangles), least);
    NodeSequence trial = gather_visits(mesh, binding, first ? first_order(binding) : order,
                                       options.cache_size, options.progress);
    used = violated_weight_of(edges, ranks_of(trial, triangles), drawn) - violated_by_ranks;
    if (used > options.slack) break;
    order = std::move(trial);
    if (binding.followers.empty()) break;
  }
  if (order.empty()) {
    const OrderConstraints all = constraints_of(ranks, 0);
    order = gather_visits(mesh, all, first_order(all), options.cache_size, options.progress);
  }
  return order;
}

}  // namespace pellucid
