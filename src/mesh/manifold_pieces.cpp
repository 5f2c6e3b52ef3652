// Oriented manifold pieces of a soup: see manifold_pieces.h.
//
// The corners of triangles are the elements: where two triangles are made neighbours across an edge, their
// corners at its ends become one vertex. A corner has two edges and at most one neighbour across each, so the
// corners of a vertex form a fan, open or closed, all of one orientation. An edge that no neighbours share
// can only be an end of such a fan, so that at most two triangles of the result have it, and they pass it in
// opposite directions. An edge with neighbours may come twice in one fan (a leaf modelled with front and back
// that are joined along the rim); it is then cut, and becomes one of the former kind.
#include "mesh/manifold_pieces.h"

#include <algorithm>
#include <numeric>

namespace pellucid {
namespace {

// The side of a triangle from its k-th corner to the next; `corner` is 3 * triangle + k.
struct TriangleSide {
  std::uint32_t low = 0, high = 0;  // welded vertices
  std::uint32_t render_low = 0, render_high = 0;
  std::uint32_t corner = 0;
  bool forward = false;  // from low to high
};

std::uint32_t next_corner(std::uint32_t corner) {
  return corner % 3 == 2 ? corner - 2 : corner + 1;
}

bool same_edge(const TriangleSide& a, const TriangleSide& b) {
  return a.low == b.low && a.high == b.high;
}
bool same_render_edge(const TriangleSide& a, const TriangleSide& b) {
  return same_edge(a, b) && a.render_low == b.render_low && a.render_high == b.render_high;
}

// Two sides that are neighbours' common edge.
struct Link {
  std::uint32_t a = 0, b = 0;  // corners where the sides begin
};

class CornerSets {
 public:
  explicit CornerSets(std::size_t corners) : parent_(corners) {
    std::iota(parent_.begin(), parent_.end(), 0U);
  }
  std::uint32_t find(std::uint32_t corner) {
    while (parent_[corner] != corner) corner = parent_[corner] = parent_[parent_[corner]];
    return corner;
  }
  void unite(std::uint32_t a, std::uint32_t b) {
    a = find(a);
    b = find(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }
  // The sides pass their edge in opposite directions.
  void unite(const Link& link) {
    unite(link.a, next_corner(link.b));
    unite(next_corner(link.a), link.b);
  }

 private:
  std::vector<std::uint32_t> parent_;
};

std::vector<TriangleSide> sorted_sides(std::span<const Triangle> triangles,
                                       std::span<const std::uint32_t> weld,
                                       const std::vector<std::uint32_t>& kept) {
  std::vector<TriangleSide> sides;
  sides.reserve(3 * kept.size());
  for (std::uint32_t i = 0; i < kept.size(); ++i) {
    const Triangle& t = triangles[kept[i]];
    for (std::uint32_t k = 0; k < 3; ++k) {
      std::uint32_t low = t[k];
      std::uint32_t high = t[(k + 1) % 3];
      const bool forward = weld[low] < weld[high];
      if (!forward) std::swap(low, high);
      sides.push_back({weld[low], weld[high], low, high, 3 * i + k, forward});
    }
  }
  std::sort(sides.begin(), sides.end(), [](const TriangleSide& a, const TriangleSide& b) {
    const auto key = [](const TriangleSide& s) {
      return std::array{s.low, s.high, s.render_low, s.render_high, s.corner};
    };
    return key(a) < key(b);
  });
  return sides;
}

// First those that share render vertices: the front and the back of a leaf that is modelled twice lie at the
// same place, but have vertices of their own.
void link_neighbours(std::span<const TriangleSide> edge, std::vector<Link>& links) {
  std::vector<TriangleSide> unlinked;
  const auto link_pair = [&links](const TriangleSide& a, const TriangleSide& b) {
    if (a.forward == b.forward) return false;
    links.push_back({a.corner, b.corner});
    return true;
  };
  for (std::size_t begin = 0; begin < edge.size();) {
    std::size_t end = begin + 1;
    while (end < edge.size() && same_render_edge(edge[begin], edge[end])) ++end;
    if (end - begin != 2 || !link_pair(edge[begin], edge[begin + 1])) {
      unlinked.insert(unlinked.end(), edge.begin() + static_cast<std::ptrdiff_t>(begin),
                      edge.begin() + static_cast<std::ptrdiff_t>(end));
    }
    begin = end;
  }
  if (unlinked.size() == 2) link_pair(unlinked[0], unlinked[1]);
}

class Splitter {
 public:
  Splitter(std::span<const Triangle> triangles, std::span<const std::uint32_t> weld)
      : triangles_(triangles), weld_(weld) {
    for (std::uint32_t t = 0; t < triangles.size(); ++t) {
      const std::uint32_t a = weld[triangles[t][0]], b = weld[triangles[t][1]], c = weld[triangles[t][2]];
      if (a != b && b != c && c != a) pieces_.source.push_back(t);
    }
  }

  ManifoldPieces run() {
    const std::vector<TriangleSide> sides = sorted_sides(triangles_, weld_, pieces_.source);
    CornerSets sets(sides.size());
    for_each_edge(sides, [&](std::span<const TriangleSide> edge) {
      std::vector<Link> links;
      link_neighbours(edge, links);
      for (const Link& link : links) sets.unite(link);
    });

    // Cuts make vertices more, never fewer, so that edges that were good remain so.
    CornerSets cut_sets(sides.size());
    for_each_edge(sides, [&](std::span<const TriangleSide> edge) {
      if (edge.size() > 2 && has_crowd(edge, sets)) return;
      std::vector<Link> links;
      link_neighbours(edge, links);
      for (const Link& link : links) cut_sets.unite(link);
    });
    number_vertices(cut_sets);
    return std::move(pieces_);
  }

 private:
  template <class Visit>
  static void for_each_edge(std::span<const TriangleSide> sides, const Visit& visit) {
    for (std::size_t begin = 0; begin < sides.size();) {
      std::size_t end = begin + 1;
      while (end < sides.size() && same_edge(sides[begin], sides[end])) ++end;
      visit(sides.subspan(begin, end - begin));
      begin = end;
    }
  }

  // Do more than two of these sides have the same vertices?
  static bool has_crowd(std::span<const TriangleSide> edge, CornerSets& sets) {
    std::vector<std::array<std::uint32_t, 2>> ends;
    for (const TriangleSide& side : edge) {
      std::array end{sets.find(side.corner), sets.find(next_corner(side.corner))};
      if (!side.forward) std::swap(end[0], end[1]);
      ends.push_back(end);
    }
    std::sort(ends.begin(), ends.end());
    for (std::size_t i = 2; i < ends.size(); ++i) {
      if (ends[i] == ends[i - 2]) return true;
    }
    return false;
  }

  void number_vertices(CornerSets& sets) {
    // Of the set's first corner, which comes before all others of it.
    std::vector<std::uint32_t> vertex(3 * pieces_.source.size());
    for (std::uint32_t i = 0; i < pieces_.source.size(); ++i) {
      Triangle& triangle = pieces_.triangles.emplace_back();
      for (std::uint32_t k = 0; k < 3; ++k) {
        const std::uint32_t corner = 3 * i + k;
        const std::uint32_t set = sets.find(corner);
        if (set == corner) {
          vertex[corner] = static_cast<std::uint32_t>(pieces_.welded.size());
          pieces_.welded.push_back(weld_[triangles_[pieces_.source[i]][k]]);
        }
        triangle[k] = vertex[set];
      }
    }
  }

  std::span<const Triangle> triangles_;
  std::span<const std::uint32_t> weld_;
  ManifoldPieces pieces_;
};

}  // namespace

ManifoldPieces make_manifold(std::span<const Triangle> triangles, std::span<const std::uint32_t> weld) {
  return Splitter(triangles, weld).run();
}

}  // namespace pellucid
