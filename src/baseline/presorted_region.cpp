// Implements presorted_region.h: makes the depth-presorted list of one view region by sifting and splitting.
#include "baseline/presorted_region.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>

#include "base/parallel.h"
#include "sequencing/cache_order.h"
#include "sequencing/linear_order.h"

namespace pellucid {
namespace {

// Rounds of sifting and splitting. Most lists are right after about ten.
constexpr int kMostRounds = 40;
// A split is made if it corrects at least this share of the contradicted weight of a copy.
constexpr double kLeastShareRighted = 0.3;
// The number of neighbours whose planes are tried for a split: those that are contradicted from the most
// viewpoints.
constexpr std::size_t kPlaneNeighbors = 6;

// A set of the region's viewpoints.
class ViewSet {
 public:
  explicit ViewSet(std::size_t views) : words_((views + 63) / 64, 0) {}
  void insert(std::size_t view) { words_[view / 64] |= std::uint64_t{1} << (view % 64); }
  [[nodiscard]] bool contains(std::size_t view) const { return (words_[view / 64] >> (view % 64) & 1U) != 0; }
  [[nodiscard]] bool empty() const {
    return std::all_of(words_.begin(), words_.end(), [](std::uint64_t word) { return word == 0; });
  }

 private:
  std::vector<std::uint64_t> words_;
};

// A node at one place of the list, drawn from the viewpoints that pass its tests.
struct Copy {
  NodeId node = 0;
  bool everywhere = true;  // no tests
  ViewSet active;          // where not everywhere
  std::vector<std::uint32_t> tests;
};

// An occlusion between a copy and a neighbour at some rank, from some viewpoints.
struct Tie {
  std::uint32_t neighbor = 0;  // copy
  std::uint32_t rank = 0;      // of the neighbour
  bool after = false;          // the neighbour must come after the copy
  std::vector<std::uint16_t> views;
};

struct Place {
  double cost = 0;      // contradicted ties, by viewpoint
  double position = 0;  // among the ranks
};

struct Split {
  std::uint32_t copy = 0;
  Plane plane;
  Place in_front, behind;
};

class RegionPresorter {
 public:
  explicit RegionPresorter(const RegionProblem& problem)
      : problem_(problem), copies_of_(problem.drawn.size()), into_offsets_(problem.drawn.size() + 1, 0) {
    for (NodeId node = 0; node < problem.drawn.size(); ++node) {
      if (problem.drawn[node] == 0) continue;
      copies_of_[node].push_back(static_cast<std::uint32_t>(copies_.size()));
      copies_.push_back({node, true, ViewSet(problem.eyes.size()), {}});
    }
    std::vector<double> keys;
    for (const Copy& copy : copies_) keys.push_back(problem.ranks[copy.node]);
    ranks_ = ranks_by_key(keys);
    hopeless_.assign(copies_.size(), 0);
    list_incoming_edges();
  }

  RegionList run() {
    RegionList result;
    EdgeRows edges;
    for (int round = 0;; ++round) {
      stop_if_requested(problem_.progress);
      edges = copy_edges();
      sift(net_preferences(edges), {}, ranks_);
      const std::vector<std::uint32_t> chosen = copies_to_split(edges);
      if (chosen.empty() || round == kMostRounds) break;
      if (copies_.size() + chosen.size() > problem_.max_copies) {
        result.complete = false;
        return result;
      }
      split_copies(chosen);
    }
    result.violated = count_violated(edges);
    result.planes = std::move(planes_);
    result.list = make_list(edges);
    return result;
  }

 private:
  void list_incoming_edges() {
    const RegionOcclusions& edges = problem_.edges;
    for (const NodeId back : edges.backs) ++into_offsets_[back + 1];
    std::partial_sum(into_offsets_.begin(), into_offsets_.end(), into_offsets_.begin());
    into_.resize(edges.backs.size());
    into_fronts_.resize(edges.backs.size());
    std::vector<std::uint64_t> cursor(into_offsets_.begin(), into_offsets_.end() - 1);
    for (NodeId front = 0; front + 1 < edges.offsets.size(); ++front) {
      for (std::uint64_t e = edges.offsets[front]; e < edges.offsets[front + 1]; ++e) {
        const std::uint64_t slot = cursor[edges.backs[e]]++;
        into_[slot] = e;
        into_fronts_[slot] = front;
      }
    }
  }

  [[nodiscard]] std::span<const std::uint16_t> views_of(std::uint64_t edge) const {
    const RegionOcclusions& edges = problem_.edges;
    return {edges.views.data() + edges.view_offsets[edge],
            static_cast<std::size_t>(edges.view_offsets[edge + 1] - edges.view_offsets[edge])};
  }

  [[nodiscard]] static bool drawn_from(const Copy& copy, std::size_t view) {
    return copy.everywhere || copy.active.contains(view);
  }

  // Returns the number of viewpoints at which both copies are drawn and one hides the other.
  [[nodiscard]] std::uint32_t common_views(std::uint64_t edge, const Copy& a, const Copy& b) const {
    const std::span<const std::uint16_t> views = views_of(edge);
    if (a.everywhere && b.everywhere) return static_cast<std::uint32_t>(views.size());
    return static_cast<std::uint32_t>(std::count_if(
        views.begin(), views.end(), [&](std::uint16_t v) { return drawn_from(a, v) && drawn_from(b, v); }));
  }

  // Occlusions between copies, weighted by the number of viewpoints that see them. Rows sorted by back copy.
  [[nodiscard]] EdgeRows copy_edges() const {
    constexpr std::size_t kRowsPerBlock = 512;
    std::vector<EdgeRows> parts((copies_.size() + kRowsPerBlock - 1) / kRowsPerBlock);
    parallel_loop(std::size_t{0}, parts.size(), [&](std::size_t block) {
      const std::size_t end = std::min((block + 1) * kRowsPerBlock, copies_.size());
      for (std::size_t copy = block * kRowsPerBlock; copy < end; ++copy)
        append_row(copies_[copy], parts[block]);
    });
    EdgeRows rows;
    rows.offsets.push_back(0);
    for (const EdgeRows& part : parts) {
      const auto base = static_cast<std::uint32_t>(rows.backs.size());
      for (const std::uint32_t offset : part.offsets) rows.offsets.push_back(base + offset);
      rows.backs.insert(rows.backs.end(), part.backs.begin(), part.backs.end());
      rows.weights.insert(rows.weights.end(), part.weights.begin(), part.weights.end());
    }
    return rows;
  }

  void append_row(const Copy& front, EdgeRows& rows) const {
    const RegionOcclusions& edges = problem_.edges;
    std::vector<std::pair<std::uint32_t, float>> row;
    for (std::uint64_t e = edges.offsets[front.node]; e < edges.offsets[front.node + 1]; ++e) {
      for (const std::uint32_t back : copies_of_[edges.backs[e]]) {
        const std::uint32_t views = common_views(e, front, copies_[back]);
        if (views > 0) row.emplace_back(back, static_cast<float>(views));
      }
    }
    std::sort(row.begin(), row.end());
    for (const auto& [back, weight] : row) {
      rows.backs.push_back(back);
      rows.weights.push_back(weight);
    }
    rows.offsets.push_back(static_cast<std::uint32_t>(rows.backs.size()));
  }

  [[nodiscard]] std::uint64_t count_violated(const EdgeRows& edges) const {
    std::uint64_t count = 0;
    for_each_violated(edges, [&](std::uint32_t, std::uint32_t) { ++count; });
    return count;
  }

  template <class Function>
  void for_each_violated(const EdgeRows& edges, const Function& function) const {
    for (std::uint32_t front = 0; front < edges.node_count(); ++front) {
      for (std::uint32_t i = edges.offsets[front]; i < edges.offsets[front + 1]; ++i) {
        if (ranks_[edges.backs[i]] < ranks_[front]) function(front, edges.backs[i]);
      }
    }
  }

  // Returns copies that cover all violated edges. Greedy: the copy with the most uncovered edges comes first.
  [[nodiscard]] std::vector<std::uint32_t> copies_to_split(const EdgeRows& edges) const {
    std::vector<std::vector<std::uint32_t>> against(copies_.size());
    for_each_violated(edges, [&](std::uint32_t front, std::uint32_t back) {
      against[front].push_back(back);
      against[back].push_back(front);
    });
    std::vector<std::uint32_t> candidates;
    for (std::uint32_t copy = 0; copy < copies_.size(); ++copy) {
      if (!against[copy].empty() && hopeless_[copy] == 0) candidates.push_back(copy);
    }
    std::stable_sort(candidates.begin(), candidates.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return against[a].size() > against[b].size(); });
    std::vector<std::uint8_t> covered(copies_.size(), 0);
    std::vector<std::uint32_t> chosen;
    for (const std::uint32_t copy : candidates) {
      const bool useful = std::any_of(against[copy].begin(), against[copy].end(),
                                      [&](std::uint32_t other) { return covered[other] == 0; });
      if (!useful) continue;
      covered[copy] = 1;
      chosen.push_back(copy);
    }
    return chosen;
  }

  // Finds the best plane of every chosen copy while all others stay, and then makes the splits that help.
  void split_copies(std::span<const std::uint32_t> chosen) {
    std::vector<std::optional<Split>> splits(chosen.size());
    parallel_loop(std::size_t{0}, chosen.size(), [&](std::size_t i) { splits[i] = best_split(chosen[i]); });
    std::vector<double> positions(ranks_.begin(), ranks_.end());
    for (std::size_t i = 0; i < chosen.size(); ++i) {
      if (splits[i]) {
        apply(*splits[i], positions);
      } else {
        hopeless_[chosen[i]] = 1;
      }
    }
    ranks_ = ranks_by_key(positions);
  }

  void apply(const Split& split, std::vector<double>& positions) {
    const auto test = static_cast<std::uint32_t>(2 * planes_.size());
    planes_.push_back(split.plane);
    Copy behind{copies_[split.copy].node, false, ViewSet(problem_.eyes.size()), copies_[split.copy].tests};
    ViewSet front(problem_.eyes.size());
    for (std::size_t view = 0; view < problem_.eyes.size(); ++view) {
      if (!drawn_from(copies_[split.copy], view)) continue;
      (side_of(split.plane, problem_.eyes[view]) >= 0 ? front : behind.active).insert(view);
    }
    Copy& in_front = copies_[split.copy];
    in_front.everywhere = false;
    in_front.active = std::move(front);
    in_front.tests.push_back(test);
    behind.tests.push_back(test + 1);
    positions[split.copy] = split.in_front.position;
    copies_of_[behind.node].push_back(static_cast<std::uint32_t>(copies_.size()));
    copies_.push_back(std::move(behind));
    positions.push_back(split.behind.position);
    hopeless_.push_back(0);
  }

  // Returns all neighbours of a copy by rank.
  [[nodiscard]] std::vector<Tie> ties_of(std::uint32_t copy) const {
    const Copy& self = copies_[copy];
    std::vector<Tie> ties;
    const auto add = [&](std::uint64_t edge, NodeId node, bool after) {
      for (const std::uint32_t other : copies_of_[node]) {
        Tie tie{other, ranks_[other], after, {}};
        for (const std::uint16_t view : views_of(edge)) {
          if (drawn_from(self, view) && drawn_from(copies_[other], view)) tie.views.push_back(view);
        }
        if (!tie.views.empty()) ties.push_back(std::move(tie));
      }
    };
    const RegionOcclusions& edges = problem_.edges;
    for (std::uint64_t e = edges.offsets[self.node]; e < edges.offsets[self.node + 1]; ++e) {
      add(e, edges.backs[e], true);
    }
    for (std::uint64_t i = into_offsets_[self.node]; i < into_offsets_[self.node + 1]; ++i) {
      add(into_[i], into_fronts_[i], false);
    }
    std::sort(ties.begin(), ties.end(), [](const Tie& a, const Tie& b) {
      return a.rank != b.rank ? a.rank < b.rank : a.after < b.after;
    });
    return ties;
  }

  // Returns the best place of a copy that is drawn where `weight` counts. Of equal places it is the nearest.
  template <class Weight>
  [[nodiscard]] static Place best_place(std::span<const Tie> ties, double here, const Weight& weight) {
    double cost = 0;  // before all neighbours: everything that must come earlier is contradicted
    for (const Tie& tie : ties) cost += tie.after ? 0 : weight(tie);
    double left = -1;
    Place best{-1, 0};
    const auto consider = [&](double right) {
      const double position = here > left && here < right ? here : 0.5 * (left + right);
      if (best.cost < 0 || cost < best.cost ||
          (cost == best.cost && std::fabs(position - here) < std::fabs(best.position - here))) {
        best = {cost, position};
      }
    };
    for (const Tie& tie : ties) {
      const double w = weight(tie);
      if (w == 0) continue;
      consider(tie.rank);
      cost += tie.after ? w : -w;
      left = tie.rank;
    }
    consider(left + 1);
    return best;
  }

  [[nodiscard]] std::optional<Split> best_split(std::uint32_t copy) const {
    const std::vector<Tie> ties = ties_of(copy);
    const double here = ranks_[copy];
    double contradicted = 0;
    std::vector<const Tie*> wrong;
    for (const Tie& tie : ties) {
      if (tie.after == (tie.rank > ranks_[copy])) continue;
      contradicted += static_cast<double>(tie.views.size());
      wrong.push_back(&tie);
    }
    std::stable_sort(wrong.begin(), wrong.end(),
                     [](const Tie* a, const Tie* b) { return a->views.size() > b->views.size(); });
    wrong.resize(std::min(wrong.size(), kPlaneNeighbors));

    Split best;
    double best_cost = (1 - kLeastShareRighted) * contradicted;
    bool found = false;
    ViewSet front(problem_.eyes.size());
    for (const Tie* tie : wrong) {
      for (const Plane& plane : boundary_planes(copies_[copy].node, copies_[tie->neighbor].node)) {
        if (!divide(copies_[copy], plane, front)) continue;
        const auto count = [&](const Tie& t, bool in_front) {
          return static_cast<double>(std::count_if(t.views.begin(), t.views.end(), [&](std::uint16_t v) {
            return front.contains(v) == in_front;
          }));
        };
        const Place in_front = best_place(ties, here, [&](const Tie& t) { return count(t, true); });
        if (in_front.cost >= best_cost) continue;
        const Place behind = best_place(ties, here, [&](const Tie& t) { return count(t, false); });
        if (in_front.cost + behind.cost >= best_cost) continue;
        best = {copy, plane, in_front, behind};
        best_cost = in_front.cost + behind.cost;
        found = true;
      }
    }
    return found ? std::optional(best) : std::nullopt;
  }

  // Finds the viewpoints of the copy that are in front of the plane. Returns false if all or none are.
  [[nodiscard]] bool divide(const Copy& copy, const Plane& plane, ViewSet& front) const {
    front = ViewSet(problem_.eyes.size());
    bool any_behind = false;
    for (std::size_t view = 0; view < problem_.eyes.size(); ++view) {
      if (!drawn_from(copy, view)) continue;
      if (side_of(plane, problem_.eyes[view]) >= 0) {
        front.insert(view);
      } else {
        any_behind = true;
      }
    }
    return any_behind && !front.empty();
  }

  // Returns the planes that bound the viewpoints from which one triangle hides the other: those through an
  // edge of the one and a corner of the other, and the planes of both.
  [[nodiscard]] std::vector<Plane> boundary_planes(NodeId a, NodeId b) const {
    std::array<std::array<Vec3d, 3>, 2> corners;
    for (std::size_t k = 0; k < 3; ++k) {
      corners[0][k] = to_double(problem_.mesh->positions[problem_.mesh->triangles[triangle_of(a)][k]]);
      corners[1][k] = to_double(problem_.mesh->positions[problem_.mesh->triangles[triangle_of(b)][k]]);
    }
    std::vector<Plane> planes;
    const auto add = [&](const Vec3d& p, const Vec3d& q, const Vec3d& r) {
      const Vec3d normal = normalized(cross(q - p, r - p));
      if (normal == Vec3d{}) return;
      planes.push_back({to_float(normal), static_cast<float>(dot(normal, p))});
    };
    for (const auto& t : corners) add(t[0], t[1], t[2]);
    for (std::size_t side = 0; side < 2; ++side) {
      for (std::size_t k = 0; k < 3; ++k) {
        for (const Vec3d& corner : corners[1 - side])
          add(corners[side][k], corners[side][(k + 1) % 3], corner);
      }
    }
    return planes;
  }

  // Returns the copies in draw order, arranged for the vertex cache if the problem has a cache size.
  [[nodiscard]] PresortedList make_list(const EdgeRows& edges) const {
    PresortedList list;
    list.test_offsets.push_back(0);
    for (const std::uint32_t copy : copy_sequence(edges)) {
      list.nodes.push_back(copies_[copy].node);
      list.tests.insert(list.tests.end(), copies_[copy].tests.begin(), copies_[copy].tests.end());
      list.test_offsets.push_back(static_cast<std::uint32_t>(list.tests.size()));
    }
    return list;
  }

  // Arrange copies for the vertex cache as a mesh with one triangle per copy, of which only the front facing
  // is drawn.
  [[nodiscard]] std::vector<std::uint32_t> copy_sequence(const EdgeRows& edges) const {
    Mesh mesh;
    EdgeRows rows;
    std::vector<std::uint32_t> ranks;
    std::vector<std::uint8_t> drawn;
    mesh.positions = problem_.mesh->positions;
    rows.offsets.push_back(0);
    for (std::uint32_t copy = 0; copy < copies_.size(); ++copy) {
      mesh.triangles.push_back(problem_.mesh->triangles[triangle_of(copies_[copy].node)]);
      ranks.insert(ranks.end(), 2, ranks_[copy]);
      drawn.insert(drawn.end(), {1, 0});
      rows.offsets.insert(rows.offsets.end(), 2, edges.offsets[copy + 1]);
    }
    for (const std::uint32_t back : edges.backs) rows.backs.push_back(node_of(back, false));
    rows.weights = edges.weights;
    std::vector<std::uint32_t> sequence =
        problem_.cache_size == 0
            ? order_by_rank(ranks, drawn)
            : cache_aware_order(mesh, rows, ranks, drawn, {CacheMethod::tipsify, problem_.cache_size, 0, 0});
    for (std::uint32_t& entry : sequence) entry = triangle_of(entry);
    return sequence;
  }

  const RegionProblem& problem_;
  std::vector<Copy> copies_;
  std::vector<std::uint32_t> ranks_;                   // per copy
  std::vector<std::vector<std::uint32_t>> copies_of_;  // per node
  std::vector<std::uint64_t> into_offsets_;            // per node: edges by back node
  std::vector<std::uint64_t> into_;
  std::vector<NodeId> into_fronts_;
  std::vector<std::uint8_t> hopeless_;  // per copy: no plane helped
  std::vector<Plane> planes_;
};

}  // namespace

namespace {

// Returns whether the faces intersect, and the back one hides more of the front one than edge `i` says for
// the opposite direction.
bool hides_more_of(const ViewpointEdges& view, NodeId behind, NodeId in_front, std::uint32_t i) {
  if (view.intersecting == 0) return false;
  const std::uint32_t t = triangle_of(behind);
  for (std::uint32_t k = view.offsets[t]; k < view.offsets[t + 1]; ++k) {
    if (view.backs[k] != in_front) continue;
    return view.areas[k] > view.areas[i] || (view.areas[k] == view.areas[i] && behind < in_front);
  }
  return false;
}

}  // namespace

RegionOcclusions collect_edges(std::span<const ViewpointEdges* const> views, std::size_t triangle_count,
                               float least_area) {
  constexpr std::size_t kRowsPerBlock = 512;
  const std::size_t node_count = 2 * triangle_count;
  std::vector<RegionOcclusions> parts((node_count + kRowsPerBlock - 1) / kRowsPerBlock);
  parallel_loop(std::size_t{0}, parts.size(), [&](std::size_t block) {
    RegionOcclusions& part = parts[block];
    std::vector<std::pair<NodeId, std::uint16_t>> row;
    const std::size_t end = std::min((block + 1) * kRowsPerBlock, node_count);
    for (std::size_t node = block * kRowsPerBlock; node < end; ++node) {
      const std::size_t t = node / 2;
      row.clear();
      for (std::size_t v = 0; v < views.size(); ++v) {
        const ViewpointEdges& view = *views[v];
        if (view.front_flipped[t] != node % 2) continue;
        for (std::uint32_t i = view.offsets[t]; i < view.offsets[t + 1]; ++i) {
          if (view.areas[i] < least_area || hides_more_of(view, view.backs[i], static_cast<NodeId>(node), i))
            continue;
          row.emplace_back(view.backs[i], static_cast<std::uint16_t>(v));
        }
      }
      std::sort(row.begin(), row.end());
      for (std::size_t i = 0; i < row.size(); ++i) {
        if (i == 0 || row[i].first != row[i - 1].first) {
          part.backs.push_back(row[i].first);
          part.view_offsets.push_back(part.views.size());
        }
        part.views.push_back(row[i].second);
      }
      part.offsets.push_back(part.backs.size());
    }
  });
  RegionOcclusions edges;
  edges.offsets.push_back(0);
  for (const RegionOcclusions& part : parts) {
    const std::uint64_t first_edge = edges.backs.size();
    const std::uint64_t first_view = edges.views.size();
    for (const std::uint64_t offset : part.offsets) edges.offsets.push_back(first_edge + offset);
    for (const std::uint64_t offset : part.view_offsets) edges.view_offsets.push_back(first_view + offset);
    edges.backs.insert(edges.backs.end(), part.backs.begin(), part.backs.end());
    edges.views.insert(edges.views.end(), part.views.begin(), part.views.end());
  }
  edges.view_offsets.push_back(edges.views.size());
  return edges;
}

RegionList presort_region(const RegionProblem& problem) {
  return RegionPresorter(problem).run();
}

}  // namespace pellucid
