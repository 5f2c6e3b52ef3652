// Implements a local search for the vertex cache: nodes move, within their constraints, to places where their
// vertices are in the cache anyway.
//
// A *visit* of a vertex is a run of its uses that one miss pays for. The search reduces the number of visits.
// Each node in turn moves to the visit of one of its vertices where this saves most, alone or together with a
// small group of dependent nodes that must stay on one side of it. A use counts more in a long visit than in
// a short one, so that visits that cannot vanish at once shrink step by step. In this way the flipped copies
// of a patch come to be next to it.
#include <algorithm>
#include <array>
#include <cmath>

#include "sequencing/cache_order.h"
#include "sequencing/fifo_cache.h"

namespace pellucid {
namespace {

// The share of the cache size that the search relies on, because a node that joins a visit may push other
// vertices out.
constexpr double kTrustedShare = 0.9;
// The bonus of long visits, in misses: a visit of n uses counts as 1 - kVisitBonus * n^1.5.
constexpr double kVisitBonus = 0.03;
// Vertices with more uses are ignored. They are few, and large fans would make the search quadratic.
constexpr std::size_t kMostUsesCounted = 64;
// The largest number of nodes that move together.
constexpr std::size_t kLargestGroup = 12;
// The least number of misses that a move must save, and by how much a place that needs a group move must be
// better than the best other place.
constexpr double kLeastGain = 1e-6;
constexpr double kLeastGroupAdvantage = 0.1;
constexpr std::uint32_t kMostSweeps = 8;
// The search stops after a sweep that moves fewer than one node in this many.
constexpr std::size_t kFewMoves = 200;

// Returns the misses of an order, and writes the number of misses after each of its nodes to `clocks`.
std::uint64_t count_misses_by_node(const Mesh& mesh, const NodeSequence& order, std::uint32_t cache_size,
                                   std::vector<std::uint32_t>& clocks) {
  FifoCache cache(mesh.positions.size(), cache_size);
  for (const NodeId node : order) {
    cache.draw(corners_of(mesh, node));
    clocks[node] = static_cast<std::uint32_t>(cache.misses());
  }
  return cache.misses();
}

OrderConstraints reversed(const OrderConstraints& constraints) {
  OrderConstraints reverse;
  reverse.offsets.assign(constraints.offsets.size(), 0);
  for (const NodeId follower : constraints.followers) ++reverse.offsets[follower + 1];
  for (std::size_t i = 1; i < reverse.offsets.size(); ++i) reverse.offsets[i] += reverse.offsets[i - 1];
  reverse.followers.resize(constraints.followers.size());
  std::vector<std::uint32_t> cursor(reverse.offsets.begin(), reverse.offsets.end() - 1);
  for (NodeId node = 0; node + 1 < constraints.offsets.size(); ++node) {
    for (const NodeId follower : constraints.followers_of(node)) reverse.followers[cursor[follower]++] = node;
  }
  return reverse;
}

std::vector<std::uint8_t> nodes_in(const NodeSequence& order, std::size_t node_count) {
  std::vector<std::uint8_t> drawn(node_count, 0);
  for (const NodeId node : order) drawn[node] = 1;
  return drawn;
}

class VisitSearch {
 public:
  VisitSearch(const Mesh& mesh, const OrderConstraints& constraints, NodeSequence order,
              std::uint32_t cache_size)
      : mesh_(mesh),
        later_(constraints),
        earlier_(reversed(constraints)),
        cache_size_(cache_size),
        reach_(std::max(1U, static_cast<std::uint32_t>(kTrustedShare * cache_size))),
        order_(std::move(order)),
        around_(mesh, nodes_in(order_, 2 * mesh.triangles.size())),
        clocks_(2 * mesh.triangles.size(), 0),
        keys_(clocks_.size(), 0),
        previous_(clocks_.size(), kNone),
        next_(clocks_.size(), kNone),
        stamps_(clocks_.size(), 0),
        unsettled_(clocks_.size(), 1) {
    for (std::size_t n = 0; n < visit_bonus_.size(); ++n) {
      visit_bonus_[n] = kVisitBonus * static_cast<double>(n) * std::sqrt(static_cast<double>(n));
    }
  }

  NodeSequence run(const Progress* progress) {
    NodeSequence best = order_;
    std::uint64_t least = count_misses_by_node(mesh_, order_, cache_size_, clocks_);
    for (std::uint32_t i = 0; i < kMostSweeps; ++i) {
      stop_if_requested(progress);
      const std::size_t moved = sweep();
      const std::uint64_t misses = count_misses_by_node(mesh_, order_, cache_size_, clocks_);
      if (misses < least) {
        least = misses;
        best = order_;
      }
      if (moved * kFewMoves < order_.size()) break;
    }
    return best;
  }

 private:
  static constexpr NodeId kNone = 0xFFFFFFFFU;
  static constexpr std::uint64_t kGap = std::uint64_t{1} << 32U;  // initially between the keys of neighbours

  [[nodiscard]] const Triangle& corners(NodeId node) const { return mesh_.triangles[triangle_of(node)]; }
  [[nodiscard]] bool counts(std::uint32_t vertex) const {
    return around_.of(vertex).size() <= kMostUsesCounted;
  }

  // ------------------------------------------------------------------------------ the order as a list

  void make_list() {
    first_ = kNone;
    NodeId last = kNone;
    std::uint64_t key = kGap;
    for (const NodeId node : order_) {
      keys_[node] = key;
      key += kGap;
      previous_[node] = last;
      (last == kNone ? first_ : next_[last]) = node;
      last = node;
    }
    if (last != kNone) next_[last] = kNone;
  }

  void read_list() {
    order_.clear();
    for (NodeId node = first_; node != kNone; node = next_[node]) order_.push_back(node);
  }

  // Returns the number of unused keys after a node.
  [[nodiscard]] std::uint64_t gap_after(NodeId node) const {
    return next_[node] == kNone ? kGap : keys_[next_[node]] - keys_[node];
  }

  void unlink(NodeId node) {
    const NodeId before = previous_[node];
    const NodeId after = next_[node];
    (before == kNone ? first_ : next_[before]) = after;
    if (after != kNone) previous_[after] = before;
  }

  void link_after(NodeId node, NodeId place) {
    keys_[node] = keys_[place] + gap_after(place) / 2;
    next_[node] = next_[place];
    previous_[node] = place;
    if (next_[place] != kNone) previous_[next_[place]] = node;
    next_[place] = node;
  }

  // -------------------------------------------------------------------------------------- what uses cost

  // The clocks at which other nodes use the vertices of a node, ascending. Empty for a vertex with too many
  // uses.
  struct OtherUses {
    std::array<std::array<std::uint32_t, kMostUsesCounted>, 3> clocks;
    std::array<std::size_t, 3> counts;
  };

  void list_other_uses(NodeId node, OtherUses& uses) const {
    for (std::size_t k = 0; k < 3; ++k) {
      auto& clocks = uses.clocks[k];
      std::size_t n = 0;
      if (counts(corners(node)[k])) {
        for (const NodeId other : around_.of(corners(node)[k])) {
          if (other == node) continue;
          std::size_t i = n++;
          for (; i > 0 && clocks[i - 1] > clocks_[other]; --i) clocks[i] = clocks[i - 1];
          clocks[i] = clocks_[other];
        }
      }
      uses.counts[k] = n;
    }
  }

  // Returns the cost of the visits of a vertex with one more use at `clock`.
  [[nodiscard]] double visits(std::span<const std::uint32_t> others, std::uint32_t clock) const {
    double cost = 0;
    std::uint32_t begin = 0;
    std::size_t uses = 0;
    const auto use = [&](std::uint32_t at) {
      if (uses == 0 || at - begin >= reach_) {
        cost += 1 - visit_bonus_[uses];
        begin = at;
        uses = 0;
      }
      ++uses;
    };
    std::size_t i = 0;
    for (; i < others.size() && others[i] < clock; ++i) use(others[i]);
    use(clock);
    for (; i < others.size(); ++i) use(others[i]);
    return cost - visit_bonus_[uses];
  }

  [[nodiscard]] double cost_at(const OtherUses& uses, std::uint32_t clock) const {
    double cost = 0;
    for (std::size_t k = 0; k < 3; ++k)
      cost += visits(std::span(uses.clocks[k]).first(uses.counts[k]), clock);
    return cost;
  }

  // ------------------------------------------------------------------------------------------------ moves

  // The keys between which a node may move: after all nodes that must come earlier and before all that must
  // come later.
  struct Window {
    std::uint64_t after, before;
    [[nodiscard]] bool allows(std::uint64_t key) const { return key >= after && key < before; }
  };
  [[nodiscard]] Window window_of(NodeId node) const {
    Window window{0, ~std::uint64_t{0}};
    for (const NodeId other : earlier_.followers_of(node))
      window.after = std::max(window.after, keys_[other]);
    for (const NodeId other : later_.followers_of(node))
      window.before = std::min(window.before, keys_[other]);
    return window;
  }

  // A place after a node that shares a vertex.
  struct Place {
    NodeId node = kNone;
    double cost = 0;
  };

  std::size_t sweep() {
    make_list();
    std::size_t moved = 0;
    for (const NodeId node : order_) {
      if (unsettled_[node] == 0) continue;
      unsettled_[node] = 0;
      if (move_to_best_place(node)) ++moved;
    }
    read_list();
    return moved;
  }

  bool move_to_best_place(NodeId node) {
    OtherUses uses;
    list_other_uses(node, uses);
    const Window window = window_of(node);
    Place inside{kNone, cost_at(uses, clocks_[node]) - kLeastGain};
    Place outside = inside;
    // Places with the same clock have the same cost, so try only the first one of each kind.
    tried_.clear();
    for (const std::uint32_t v : corners(node)) {
      if (!counts(v)) continue;
      for (const NodeId other : around_.of(v)) {
        if (clocks_[other] == clocks_[node]) continue;
        const bool allowed = window.allows(keys_[other]);
        const std::uint64_t kind = std::uint64_t{clocks_[other]} << 1U | (allowed ? 1U : 0U);
        if (std::find(tried_.begin(), tried_.end(), kind) != tried_.end()) continue;
        tried_.push_back(kind);
        const double cost = cost_at(uses, clocks_[other]);
        Place& best = allowed ? inside : outside;
        if (cost < best.cost) best = {other, cost};
      }
    }
    if (outside.node != kNone && outside.cost < inside.cost - kLeastGroupAdvantage &&
        move_group(node, outside.node)) {
      return true;
    }
    if (inside.node == kNone || gap_after(inside.node) < 2) return false;
    unlink(node);
    link_after(node, inside.node);
    set_clock(node, clocks_[inside.node]);
    return true;
  }

  // Moves a node behind `place`, together with the dependent nodes between them. Returns false if these are
  // too many or if the move gains nothing.
  bool move_group(NodeId node, NodeId place) {
    if (!collect_group(node, place)) return false;
    if (gap_after(place) >> group_.size() < 2) return false;
    // Evaluate one node after the other, so that later ones see the earlier ones at the new place.
    double gain = 0;
    OtherUses uses;
    before_.clear();
    for (const NodeId member : group_) {
      list_other_uses(member, uses);
      before_.push_back(clocks_[member]);
      gain += cost_at(uses, clocks_[member]) - cost_at(uses, clocks_[place]);
      clocks_[member] = clocks_[place];
    }
    for (std::size_t i = 0; i < group_.size(); ++i) clocks_[group_[i]] = before_[i];
    if (gain < kLeastGain) return false;

    std::sort(group_.begin(), group_.end(),
              [&](NodeId a, NodeId b) { return keys_[a] != keys_[b] ? keys_[a] < keys_[b] : a < b; });
    NodeId last = place;
    for (const NodeId member : group_) {
      unlink(member);
      link_after(member, last);
      set_clock(member, clocks_[place]);
      last = member;
    }
    return true;
  }

  // Collects the node and all nodes between it and `place` that depend on it, directly or through others.
  // Returns false if they are too many.
  bool collect_group(NodeId node, NodeId place) {
    const bool to_front = keys_[place] < keys_[node];
    const OrderConstraints& bound = to_front ? earlier_ : later_;
    ++stamp_;
    group_.assign(1, node);
    for (std::size_t i = 0; i < group_.size(); ++i) {
      for (const NodeId other : bound.followers_of(group_[i])) {
        const bool in_the_way = to_front ? keys_[other] > keys_[place] : keys_[other] <= keys_[place];
        if (!in_the_way || stamps_[other] == stamp_) continue;
        if (other == place || group_.size() == kLargestGroup) return false;
        stamps_[other] = stamp_;
        group_.push_back(other);
      }
    }
    return true;
  }

  // Sets the clock of a moved node. Nodes that share a vertex with it are visited again, because they may
  // have better places now.
  void set_clock(NodeId node, std::uint32_t clock) {
    clocks_[node] = clock;
    for (const std::uint32_t v : corners(node)) {
      if (!counts(v)) continue;
      for (const NodeId other : around_.of(v)) unsettled_[other] = 1;
    }
  }

  const Mesh& mesh_;
  const OrderConstraints& later_;
  OrderConstraints earlier_;
  std::uint32_t cache_size_;
  std::uint32_t reach_;  // the number of misses for which a vertex stays in the cache
  NodeSequence order_;
  VertexNodes around_;
  std::vector<std::uint32_t> clocks_;  // per node: the number of misses after it has been drawn
  std::vector<std::uint64_t> keys_;    // ascending along the list
  std::vector<NodeId> previous_, next_;
  NodeId first_ = kNone;
  std::vector<std::uint32_t> stamps_;
  std::uint32_t stamp_ = 0;
  std::vector<std::uint8_t> unsettled_;  // nodes to visit in the next sweep
  std::array<double, kMostUsesCounted + 1> visit_bonus_{};
  std::vector<std::uint64_t> tried_;
  std::vector<NodeId> group_;
  std::vector<std::uint32_t> before_;
};

}  // namespace

NodeSequence gather_visits(const Mesh& mesh, const OrderConstraints& constraints, NodeSequence order,
                           std::uint32_t cache_size, const Progress* progress) {
  return VisitSearch(mesh, constraints, std::move(order), cache_size).run(progress);
}

}  // namespace pellucid
