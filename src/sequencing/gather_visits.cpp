// Local search for the vertex cache: see gather_visits.h.
#include "sequencing/gather_visits.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "sequencing/fifo_cache.h"
#include "sequencing/vertex_nodes.h"

namespace pellucid {
namespace {

// The FIFO holds `cache_size` vertices, but a node that joins a visit may push others out: count on less.
constexpr double kTrustedShare = 0.9;
// What a use saves by company, misses: a visit of n uses is worth kCompany * n^1.5.
constexpr double kCompany = 0.03;
// Vertices with more uses are left out: they are few, and fans would make the search quadratic.
constexpr std::size_t kMostUsesCounted = 64;
// Nodes that may move together.
constexpr std::size_t kMostCompanions = 12;
// A move must save this much, misses; moving others out of the way must promise more to be tried.
constexpr double kLeastGain = 1e-6;
constexpr double kWorthDragging = 0.1;
constexpr std::uint32_t kMostSweeps = 8;
// Stop when a sweep moves fewer than one node in so many.
constexpr std::size_t kStillness = 200;

// Returns the misses of a sequence, and writes the miss count after each of its nodes to `clocks`.
std::uint64_t count_misses_by_node(const Mesh& mesh, const NodeSequence& sequence, std::uint32_t cache_size,
                                   std::vector<std::uint32_t>& clocks) {
  FifoCache cache(mesh.positions.size(), cache_size);
  for (const NodeId node : sequence) {
    cache.draw(corners_of(mesh, node));
    clocks[node] = static_cast<std::uint32_t>(cache.misses());
  }
  return cache.misses();
}

SequenceConstraints reversed(const SequenceConstraints& constraints) {
  SequenceConstraints reverse;
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

std::vector<std::uint8_t> nodes_in(const NodeSequence& sequence, std::size_t node_count) {
  std::vector<std::uint8_t> drawn(node_count, 0);
  for (const NodeId node : sequence) drawn[node] = 1;
  return drawn;
}

class VisitSearch {
 public:
  VisitSearch(const Mesh& mesh, const SequenceConstraints& constraints, NodeSequence sequence,
              std::uint32_t cache_size)
      : mesh_(mesh),
        later_(constraints),
        earlier_(reversed(constraints)),
        cache_size_(cache_size),
        reach_(std::max(1U, static_cast<std::uint32_t>(kTrustedShare * cache_size))),
        sequence_(std::move(sequence)),
        around_(mesh, nodes_in(sequence_, 2 * mesh.triangles.size())),
        clocks_(2 * mesh.triangles.size(), 0),
        keys_(clocks_.size(), 0),
        previous_(clocks_.size(), kNone),
        next_(clocks_.size(), kNone),
        stamps_(clocks_.size(), 0),
        unsettled_(clocks_.size(), 1) {
    for (std::size_t n = 0; n < company_.size(); ++n) {
      company_[n] = kCompany * static_cast<double>(n) * std::sqrt(static_cast<double>(n));
    }
  }

  NodeSequence run(const Progress* progress) {
    NodeSequence best = sequence_;
    std::uint64_t least = count_misses_by_node(mesh_, sequence_, cache_size_, clocks_);
    for (std::uint32_t i = 0; i < kMostSweeps; ++i) {
      stop_if_requested(progress);
      const std::size_t moved = sweep();
      const std::uint64_t misses = count_misses_by_node(mesh_, sequence_, cache_size_, clocks_);
      if (misses < least) {
        least = misses;
        best = sequence_;
      }
      if (moved * kStillness < sequence_.size()) break;
    }
    return best;
  }

 private:
  static constexpr NodeId kNone = 0xFFFFFFFFU;
  static constexpr std::uint64_t kGap = std::uint64_t{1} << 32U;  // between the keys of neighbours at first

  [[nodiscard]] const Triangle& corners(NodeId node) const { return mesh_.triangles[triangle_of(node)]; }
  [[nodiscard]] bool counts(std::uint32_t vertex) const {
    return around_.of(vertex).size() <= kMostUsesCounted;
  }

  // ------------------------------------------------------------------------------ the sequence as a list

  void make_list() {
    first_ = kNone;
    NodeId last = kNone;
    std::uint64_t key = kGap;
    for (const NodeId node : sequence_) {
      keys_[node] = key;
      key += kGap;
      previous_[node] = last;
      (last == kNone ? first_ : next_[last]) = node;
      last = node;
    }
    if (last != kNone) next_[last] = kNone;
  }

  void read_list() {
    sequence_.clear();
    for (NodeId node = first_; node != kNone; node = next_[node]) sequence_.push_back(node);
  }

  // Keys that are free after a node.
  [[nodiscard]] std::uint64_t room_after(NodeId node) const {
    return next_[node] == kNone ? kGap : keys_[next_[node]] - keys_[node];
  }

  void unlink(NodeId node) {
    const NodeId before = previous_[node];
    const NodeId after = next_[node];
    (before == kNone ? first_ : next_[before]) = after;
    if (after != kNone) previous_[after] = before;
  }

  void link_after(NodeId node, NodeId place) {
    keys_[node] = keys_[place] + room_after(place) / 2;
    next_[node] = next_[place];
    previous_[node] = place;
    if (next_[place] != kNone) previous_[next_[place]] = node;
    next_[place] = node;
  }

  // -------------------------------------------------------------------------------------- what uses cost

  // Clocks of the uses of a node's vertices by other nodes, ascending; none for a vertex that does not count.
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

  // Visits of a vertex, company deducted, with one more use at `clock`.
  [[nodiscard]] double visits(std::span<const std::uint32_t> others, std::uint32_t clock) const {
    double cost = 0;
    std::uint32_t begin = 0;
    std::size_t uses = 0;
    const auto use = [&](std::uint32_t at) {
      if (uses == 0 || at - begin >= reach_) {
        cost += 1 - company_[uses];
        begin = at;
        uses = 0;
      }
      ++uses;
    };
    std::size_t i = 0;
    for (; i < others.size() && others[i] < clock; ++i) use(others[i]);
    use(clock);
    for (; i < others.size(); ++i) use(others[i]);
    return cost - company_[uses];
  }

  [[nodiscard]] double cost_at(const OtherUses& uses, std::uint32_t clock) const {
    double cost = 0;
    for (std::size_t k = 0; k < 3; ++k)
      cost += visits(std::span(uses.clocks[k]).first(uses.counts[k]), clock);
    return cost;
  }

  // ------------------------------------------------------------------------------------------------ moves

  // The keys between which a node may move: after all that must come earlier, before all that must come
  // later.
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

  // A place beside a node that shares a vertex.
  struct Place {
    NodeId node = kNone;
    double cost = 0;
  };

  std::size_t sweep() {
    make_list();
    std::size_t moved = 0;
    for (const NodeId node : sequence_) {
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
    // Places of one clock cost the same: the first of each kind stands for them.
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
    if (outside.node != kNone && outside.cost < inside.cost - kWorthDragging && drag(node, outside.node)) {
      return true;
    }
    if (inside.node == kNone || room_after(inside.node) < 2) return false;
    unlink(node);
    link_after(node, inside.node);
    settle_again(node, clocks_[inside.node]);
    return true;
  }

  // Move a node behind `place`, and with it all that is bound to stay on its side. False: too many, or no
  // gain.
  bool drag(NodeId node, NodeId place) {
    if (!collect_companions(node, place)) return false;
    if (room_after(place) >> companions_.size() < 2) return false;
    // One after the other, so that later ones find the earlier ones there.
    double gain = 0;
    OtherUses uses;
    before_.clear();
    for (const NodeId companion : companions_) {
      list_other_uses(companion, uses);
      before_.push_back(clocks_[companion]);
      gain += cost_at(uses, clocks_[companion]) - cost_at(uses, clocks_[place]);
      clocks_[companion] = clocks_[place];
    }
    for (std::size_t i = 0; i < companions_.size(); ++i) clocks_[companions_[i]] = before_[i];
    if (gain < kLeastGain) return false;

    std::sort(companions_.begin(), companions_.end(),
              [&](NodeId a, NodeId b) { return keys_[a] != keys_[b] ? keys_[a] < keys_[b] : a < b; });
    NodeId last = place;
    for (const NodeId companion : companions_) {
      unlink(companion);
      link_after(companion, last);
      settle_again(companion, clocks_[place]);
      last = companion;
    }
    return true;
  }

  // The node and what stands between it and `place` and is bound to it, directly or through others.
  bool collect_companions(NodeId node, NodeId place) {
    const bool to_front = keys_[place] < keys_[node];
    const SequenceConstraints& bound = to_front ? earlier_ : later_;
    ++stamp_;
    companions_.assign(1, node);
    for (std::size_t i = 0; i < companions_.size(); ++i) {
      for (const NodeId other : bound.followers_of(companions_[i])) {
        const bool in_the_way = to_front ? keys_[other] > keys_[place] : keys_[other] <= keys_[place];
        if (!in_the_way || stamps_[other] == stamp_) continue;
        if (other == place || companions_.size() == kMostCompanions) return false;
        stamps_[other] = stamp_;
        companions_.push_back(other);
      }
    }
    return true;
  }

  // A node has a new clock: what shares a vertex with it may have a better place now.
  void settle_again(NodeId node, std::uint32_t clock) {
    clocks_[node] = clock;
    for (const std::uint32_t v : corners(node)) {
      if (!counts(v)) continue;
      for (const NodeId other : around_.of(v)) unsettled_[other] = 1;
    }
  }

  const Mesh& mesh_;
  const SequenceConstraints& later_;
  SequenceConstraints earlier_;
  std::uint32_t cache_size_;
  std::uint32_t reach_;  // misses that a vertex stays in the cache for
  NodeSequence sequence_;
  VertexNodes around_;
  std::vector<std::uint32_t> clocks_;  // misses so far, when a node has been drawn
  std::vector<std::uint64_t> keys_;    // ascending along the list
  std::vector<NodeId> previous_, next_;
  NodeId first_ = kNone;
  std::vector<std::uint32_t> stamps_;
  std::uint32_t stamp_ = 0;
  std::vector<std::uint8_t> unsettled_;  // nodes to look at in the next sweep
  std::array<double, kMostUsesCounted + 1> company_{};
  std::vector<std::uint64_t> tried_;
  std::vector<NodeId> companions_;
  std::vector<std::uint32_t> before_;
};

}  // namespace

NodeSequence gather_visits(const Mesh& mesh, const SequenceConstraints& constraints, NodeSequence sequence,
                           std::uint32_t cache_size, const Progress* progress) {
  return VisitSearch(mesh, constraints, std::move(sequence), cache_size).run(progress);
}

}  // namespace pellucid
