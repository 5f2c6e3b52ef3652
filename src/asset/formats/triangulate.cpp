// Implements triangulate() of foreign_model.h: ear clipping (Meisters 1975) of polygons with any number of
// corners. Orientations are exact (Shewchuk, "Adaptive Precision Floating-Point Arithmetic", 1997), and a
// tree over the reflex corners finds those that may lie in an ear.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include "asset/formats/foreign_model.h"

namespace pellucid {
namespace {

// A corner in the plane. Coordinates are those of a float32, so that a product of two is exact in a double.
struct Point {
  double x = 0, y = 0;

  bool operator==(const Point&) const = default;
};

// Returns the sign of an exact sum. Each step adds one number to an expansion of numbers that do not overlap.
int sign_of_sum(const std::array<double, 6>& numbers) {
  std::array<double, 6> parts{};
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    double sum = numbers[i];
    for (std::size_t k = 0; k < i; ++k) {
      const double total = sum + parts[k];
      const double virtual_part = total - sum;
      parts[k] = (sum - (total - virtual_part)) + (parts[k] - virtual_part);
      sum = total;
    }
    parts[i] = sum;
  }
  // The last part that is not zero is larger than all before it together.
  for (std::size_t k = parts.size(); k-- > 0;) {
    if (parts[k] != 0) return parts[k] > 0 ? 1 : -1;
  }
  return 0;
}

// Returns 1 if a, b, c turn left, -1 if they turn right, and 0 if they lie on a line.
int turn(const Point& a, const Point& b, const Point& c) {
  const double left = (b.x - a.x) * (c.y - a.y);
  const double right = (b.y - a.y) * (c.x - a.x);
  const double bound = 4.5e-16 * (std::fabs(left) + std::fabs(right));
  if (left - right > bound) return 1;
  if (right - left > bound) return -1;
  return sign_of_sum({b.x * c.y, -b.x * a.y, -a.x * c.y, -b.y * c.x, b.y * a.x, a.y * c.x});
}

// Returns Newell's normal. It is as long as twice the polygon's area.
Vec3d polygon_normal(std::span<const std::uint32_t> corners, std::span<const Vec3f> positions) {
  const Vec3d origin = to_double(positions[corners[0]]);
  Vec3d sum;
  for (std::size_t i = 1; i + 1 < corners.size(); ++i) {
    sum += cross(to_double(positions[corners[i]]) - origin, to_double(positions[corners[i + 1]]) - origin);
  }
  return sum;
}

// Drops the axis along which the normal is longest, and swaps the others where that keeps left turns left.
std::vector<Point> projected(std::span<const std::uint32_t> corners, std::span<const Vec3f> positions,
                             const Vec3d& normal) {
  const Vec3d size{std::fabs(normal.x), std::fabs(normal.y), std::fabs(normal.z)};
  std::vector<Point> points;
  points.reserve(corners.size());
  for (const std::uint32_t corner : corners) {
    const Vec3d p = to_double(positions[corner]);
    if (size.x >= size.y && size.x >= size.z) {
      points.push_back(normal.x > 0 ? Point{p.y, p.z} : Point{p.z, p.y});
    } else if (size.y >= size.z) {
      points.push_back(normal.y > 0 ? Point{p.z, p.x} : Point{p.x, p.z});
    } else {
      points.push_back(normal.z > 0 ? Point{p.x, p.y} : Point{p.y, p.x});
    }
  }
  return points;
}

struct Box {
  Point low{INFINITY, INFINITY}, high{-INFINITY, -INFINITY};

  void add(const Point& p) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y)};
  }
};

// Returns whether the whole box certainly lies to the right of the line from p to q.
bool is_right_of(const Box& box, const Point& p, const Point& q) {
  const double dx = q.x - p.x;
  const double dy = q.y - p.y;
  const double up = dx * ((dx > 0 ? box.high.y : box.low.y) - p.y);
  const double across = dy * ((dy > 0 ? box.low.x : box.high.x) - p.x);
  return up - across < -1e-12 * (std::fabs(up) + std::fabs(across));
}

// A k-d tree over corners, from which corners are removed one by one.
class CornerTree {
 public:
  CornerTree(const std::vector<Point>& points, std::vector<std::uint32_t> corners)
      : points_(points), corners_(std::move(corners)), leaf_of_(points.size(), kNone) {
    if (!corners_.empty()) build(0, static_cast<std::uint32_t>(corners_.size()), kNone);
  }

  void remove(std::uint32_t corner) {
    for (std::uint32_t node = leaf_of_[corner]; node != kNone; node = nodes_[node].parent)
      --nodes_[node].left_over;
  }

  // Calls `test` with corners in or near the triangle a, b, c, which turns left, until it returns true.
  // Returns whether it did. Adds the number of steps to `steps`.
  template <class Test>
  bool any(const Point& a, const Point& b, const Point& c, std::uint64_t& steps, const Test& test) const {
    std::array<std::uint32_t, 128> pending{};
    std::size_t count = 0;
    if (!nodes_.empty()) pending[count++] = 0;
    while (count > 0) {
      const Node& node = nodes_[pending[--count]];
      ++steps;
      if (node.left_over == 0 || is_right_of(node.box, a, b) || is_right_of(node.box, b, c) ||
          is_right_of(node.box, c, a))
        continue;
      if (node.second_child != kNone) {
        pending[count++] = node.second_child;
        pending[count++] = static_cast<std::uint32_t>(&node - nodes_.data()) + 1;
        continue;
      }
      for (std::uint32_t i = node.begin; i < node.end; ++i) {
        if (test(corners_[i])) return true;
      }
    }
    return false;
  }

 private:
  static constexpr std::uint32_t kNone = ~0U;
  static constexpr std::uint32_t kLeafCorners = 8;
  // The first child of an inner node follows it.
  struct Node {
    Box box;
    std::uint32_t begin = 0, end = 0;  // of its corners
    std::uint32_t second_child = kNone, parent = kNone;
    std::uint32_t left_over = 0;  // corners that have not been removed
  };

  std::uint32_t build(std::uint32_t begin, std::uint32_t end, std::uint32_t parent) {
    const auto number = static_cast<std::uint32_t>(nodes_.size());
    Node node{{}, begin, end, kNone, parent, end - begin};
    for (std::uint32_t i = begin; i < end; ++i) node.box.add(points_[corners_[i]]);
    nodes_.push_back(node);
    if (end - begin <= kLeafCorners) {
      for (std::uint32_t i = begin; i < end; ++i) leaf_of_[corners_[i]] = number;
      return number;
    }
    const bool wide = node.box.high.x - node.box.low.x > node.box.high.y - node.box.low.y;
    const std::uint32_t middle = begin + (end - begin) / 2;
    const auto first = corners_.begin();
    std::nth_element(first + begin, first + middle, first + end, [&](std::uint32_t a, std::uint32_t b) {
      const double key_a = wide ? points_[a].x : points_[a].y;
      const double key_b = wide ? points_[b].x : points_[b].y;
      return key_a < key_b || (key_a == key_b && a < b);
    });
    build(begin, middle, number);
    nodes_[number].second_child = build(middle, end, number);
    return number;
  }

  const std::vector<Point>& points_;
  std::vector<std::uint32_t> corners_;  // those of a node are consecutive
  std::vector<std::uint32_t> leaf_of_;  // by corner
  std::vector<Node> nodes_;
};

class EarClipper {
 public:
  EarClipper(std::span<const std::uint32_t> corners, std::vector<Point> points)
      : corners_(corners),
        points_(std::move(points)),
        next_(corners.size()),
        previous_(corners.size()),
        left_(corners.size(), 1) {
    const auto n = static_cast<std::uint32_t>(corners.size());
    for (std::uint32_t i = 0; i < n; ++i) {
      next_[i] = (i + 1) % n;
      previous_[i] = (i + n - 1) % n;
    }
  }

  [[nodiscard]] bool convex() const {
    for (std::uint32_t i = 0; i < corners_.size(); ++i) {
      const int direction = turn_at(i);
      if (direction < 0 || (direction == 0 && !goes_on(i))) return false;
    }
    return true;
  }

  void clip(std::vector<Triangle>& triangles) {
    CornerTree tree(points_, blocking_corners());
    std::size_t left = corners_.size();
    const std::uint64_t most_steps = kStepsPerCorner * left;
    std::uint64_t steps = 0;
    std::uint32_t at = 0;
    std::size_t fruitless = 0;
    int lenience = 0;
    while (left > 3) {
      if (steps < most_steps && lenience < kAnything && !is_ear(at, lenience, tree, steps)) {
        at = next_[at];
        if (++fruitless < left) continue;
        ++lenience;
        fruitless = 0;
        continue;
      }
      triangles.push_back({corners_[previous_[at]], corners_[at], corners_[next_[at]]});
      left_[at] = 0;
      tree.remove(at);
      next_[previous_[at]] = next_[at];
      previous_[next_[at]] = previous_[at];
      at = previous_[at];
      fruitless = 0;
      lenience = 0;
      --left;
    }
    triangles.push_back({corners_[previous_[at]], corners_[at], corners_[next_[at]]});
  }

 private:
  // What counts as an ear, if a whole round has found none that is better: a corner on a line (its triangle
  // has no area), an ear with other corners on its border, and in a polygon that intersects itself any
  // corner.
  enum Lenience { kStrict = 0, kOnLine, kTouched, kAnything };
  // Bounds the time for hostile polygons; others need some dozens of steps a corner.
  static constexpr std::uint64_t kStepsPerCorner = 16384;

  // Returns whether the outline goes on in its direction at a corner on a line. Where it turns back or stands
  // still (two corners at one place), that corner hides the turn of its neighbour.
  [[nodiscard]] bool goes_on(std::uint32_t b) const {
    const Point& p = points_[b];
    const Point& before = points_[previous_[b]];
    const Point& after = points_[next_[b]];
    return (p.x - before.x) * (after.x - p.x) + (p.y - before.y) * (after.y - p.y) > 0;
  }

  [[nodiscard]] int turn_at(std::uint32_t b) const {
    return turn(points_[previous_[b]], points_[b], points_[next_[b]]);
  }

  // Corners that may lie in an ear: in a simple polygon only reflex ones. Where several corners share a
  // place, the edges of each may cross an ear of another.
  [[nodiscard]] std::vector<std::uint32_t> blocking_corners() const {
    std::map<std::pair<double, double>, int> at_place;
    for (const Point& p : points_) ++at_place[{p.x, p.y}];
    std::vector<std::uint32_t> blocking;
    for (std::uint32_t i = 0; i < corners_.size(); ++i) {
      if (turn_at(i) <= 0 || at_place[{points_[i].x, points_[i].y}] > 1) blocking.push_back(i);
    }
    return blocking;
  }

  // Returns whether the direction from b to p lies strictly between those to c and a, where a, b, c turn
  // left.
  [[nodiscard]] bool points_into(const Point& p, const Point& a, const Point& b, const Point& c) const {
    return turn(b, c, p) > 0 && turn(b, p, a) > 0;
  }

  [[nodiscard]] bool is_ear(std::uint32_t at, int lenience, const CornerTree& tree,
                            std::uint64_t& steps) const {
    const Point& a = points_[previous_[at]];
    const Point& b = points_[at];
    const Point& c = points_[next_[at]];
    const int direction = turn(a, b, c);
    ++steps;
    if (direction == 0) return lenience >= kOnLine;
    if (direction < 0) return false;
    const auto blocks = [&](std::uint32_t i) {
      if (left_[i] == 0 || i == at || i == previous_[at] || i == next_[at]) return false;
      ++steps;
      const Point& p = points_[i];
      if (p == a || p == c) return false;
      // An edge that leaves from the place of the ear's tip into the ear crosses its base.
      if (p == b)
        return points_into(points_[next_[i]], a, b, c) || points_into(points_[previous_[i]], a, b, c);
      const int ab = turn(a, b, p);
      const int bc = turn(b, c, p);
      const int ca = turn(c, a, p);
      if (lenience >= kTouched) return ab > 0 && bc > 0 && ca > 0;
      return ab >= 0 && bc >= 0 && ca >= 0;
    };
    return !tree.any(a, b, c, steps, blocks);
  }

  std::span<const std::uint32_t> corners_;
  std::vector<Point> points_;
  std::vector<std::uint32_t> next_, previous_;
  std::vector<std::uint8_t> left_;  // 0: clipped
};

void fan(std::span<const std::uint32_t> corners, std::vector<Triangle>& triangles) {
  for (std::size_t i = 1; i + 1 < corners.size(); ++i) {
    triangles.push_back({corners[0], corners[i], corners[i + 1]});
  }
}

Vec3d corner_normal(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::span<const Vec3f> positions) {
  const Vec3d p = to_double(positions[a]);
  return cross(to_double(positions[b]) - p, to_double(positions[c]) - p);
}

void split_quad(std::span<const std::uint32_t> c, std::span<const Vec3f> positions,
                std::vector<Triangle>& triangles) {
  const double agree_02 =
      dot(corner_normal(c[0], c[1], c[2], positions), corner_normal(c[0], c[2], c[3], positions));
  const double agree_13 =
      dot(corner_normal(c[1], c[2], c[3], positions), corner_normal(c[1], c[3], c[0], positions));
  if (!(agree_02 > 0) && agree_13 > agree_02) {
    triangles.push_back({c[0], c[1], c[3]});
    triangles.push_back({c[1], c[2], c[3]});
  } else {
    fan(c, triangles);
  }
}

}  // namespace

void triangulate(std::span<const std::uint32_t> corners, std::span<const Vec3f> positions,
                 std::vector<Triangle>& triangles) {
  if (corners.size() == 4) return split_quad(corners, positions, triangles);
  if (corners.size() > 4) {
    const Vec3d normal = polygon_normal(corners, positions);
    const double area = length(normal);
    if (area > 0 && std::isfinite(area)) {
      EarClipper clipper(corners, projected(corners, positions, normal));
      if (!clipper.convex()) return clipper.clip(triangles);
    }
  }
  fan(corners, triangles);
}

}  // namespace pellucid
