// From a partial order to a drawing sequence: see sequence.h.
#include "sequencing/sequence.h"

#include <algorithm>
#include <array>
#include <bit>

#include "sequencing/fifo_cache.h"
#include "sequencing/gather_visits.h"
#include "sequencing/list_schedule.h"
#include "sequencing/tipsify.h"

namespace pellucid {
namespace {

// Nodes whose reachability is kept at a time: bounds the memory of the transitive reduction.
constexpr std::uint32_t kColumns = 8192;
constexpr std::uint32_t kWords = kColumns / 64;
// From one weight of lifted constraints to the next.
constexpr float kNextLeast = 2;
// The next step is tried while less than this share of the slack is used: it would hardly be kept otherwise.
constexpr double kSlackToGoOn = 0.5;

// Constraints between positions of a sequence instead of nodes, rows ascending.
class PositionRows {
 public:
  PositionRows(const SequenceConstraints& constraints, const NodeSequence& sequence)
      : constraints_(constraints), sequence_(sequence), positions_(constraints.offsets.size() - 1, 0) {
    for (std::uint32_t i = 0; i < sequence.size(); ++i) positions_[sequence[i]] = i;
  }
  // Sets a bit for every follower of a position within [begin, begin + kColumns).
  void mark(std::uint32_t position, std::uint32_t begin, std::span<std::uint64_t> bits) const {
    for (const NodeId follower : constraints_.followers_of(sequence_[position])) {
      const std::uint32_t column = positions_[follower] - begin;
      if (column < kColumns) bits[column / 64] |= std::uint64_t{1} << (column % 64);
    }
  }

 private:
  const SequenceConstraints& constraints_;
  const NodeSequence& sequence_;
  std::vector<std::uint32_t> positions_;
};

}  // namespace

SequenceConstraints agreeing_edges(const EdgeRows& edges, std::span<const std::uint32_t> ranks,
                                   std::span<const std::uint8_t> drawn, float least) {
  SequenceConstraints constraints;
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

SequenceConstraints without_implied(const SequenceConstraints& constraints,
                                    std::span<const std::uint32_t> ranks,
                                    std::span<const std::uint8_t> drawn) {
  // Columns are followers by position, a block of them at a time; from the last node to the first, a follower
  // is implied where a nearer one reaches it.
  const NodeSequence sequence = rank_sequence(ranks, drawn);
  const auto count = static_cast<std::uint32_t>(sequence.size());
  const PositionRows rows(constraints, sequence);
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
  SequenceConstraints reduced;
  reduced.offsets.assign(constraints.offsets.size(), 0);
  for (std::uint32_t i = 0; i < count; ++i) {
    reduced.offsets[sequence[i] + 1] = static_cast<std::uint32_t>(kept[i].size());
  }
  for (std::size_t i = 1; i < reduced.offsets.size(); ++i) reduced.offsets[i] += reduced.offsets[i - 1];
  reduced.followers.resize(reduced.offsets.back());
  for (std::uint32_t i = 0; i < count; ++i) {
    std::transform(kept[i].begin(), kept[i].end(), reduced.followers.begin() + reduced.offsets[sequence[i]],
                   [&](std::uint32_t position) { return sequence[position]; });
  }
  return reduced;
}

NodeSequence rank_sequence(std::span<const std::uint32_t> ranks, std::span<const std::uint8_t> drawn) {
  NodeSequence sequence;
  for (NodeId node = 0; node < drawn.size(); ++node) {
    if (drawn[node] != 0) sequence.push_back(node);
  }
  std::sort(sequence.begin(), sequence.end(), [&](NodeId a, NodeId b) { return ranks[a] < ranks[b]; });
  return sequence;
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

NodeSequence cache_aware_sequence(const Mesh& mesh, const EdgeRows& edges,
                                  std::span<const std::uint32_t> ranks, std::span<const std::uint8_t> drawn,
                                  const SequenceOptions& options) {
  const std::uint64_t triangles = mesh.triangles.size();
  const NodeSequence by_rank = rank_sequence(ranks, drawn);
  const auto constraints_of = [&](std::span<const std::uint32_t> order, float least) {
    stop_if_requested(options.progress);
    return without_implied(agreeing_edges(edges, order, drawn, least), order, drawn);
  };
  // A method's sequence, or the rank order where that has fewer misses.
  const auto first_sequence = [&](const SequenceConstraints& constraints) {
    const auto method = options.method == CacheMethod::tipsify ? tipsify : list_schedule;
    NodeSequence sequence = method(mesh, constraints, ranks, drawn, options.cache_size);
    const bool better =
        fifo_misses(mesh, sequence, options.cache_size) <= fifo_misses(mesh, by_rank, options.cache_size);
    return better ? sequence : by_rank;
  };
  if (options.method == CacheMethod::tipsify) {
    return first_sequence(constraints_of(ranks, options.least_binding));
  }

  // Without the lightest constraints, then without heavier ones, until that costs more than the slack.
  const double violated_by_ranks = violated_weight_of(edges, ranks, drawn);
  NodeSequence sequence;
  double used = 0;
  for (float least = options.least_binding; least > 0 && used < kSlackToGoOn * options.slack;
       least *= kNextLeast) {
    const bool first = sequence.empty();
    const SequenceConstraints binding = constraints_of(
        first ? std::vector<std::uint32_t>(ranks.begin(), ranks.end()) : ranks_of(sequence, triangles),
        least);
    NodeSequence trial = gather_visits(mesh, binding, first ? first_sequence(binding) : sequence,
                                       options.cache_size, options.progress);
    used = violated_weight_of(edges, ranks_of(trial, triangles), drawn) - violated_by_ranks;
    if (used > options.slack) break;
    sequence = std::move(trial);
    if (binding.followers.empty()) break;
  }
  if (sequence.empty()) {
    const SequenceConstraints all = constraints_of(ranks, 0);
    sequence = gather_visits(mesh, all, first_sequence(all), options.cache_size, options.progress);
  }
  return sequence;
}

}  // namespace pellucid
