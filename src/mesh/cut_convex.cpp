// A convex polygon cut by a plane: see pellucid/split.h.
#include <algorithm>
#include <cmath>

#include "pellucid/split.h"

namespace pellucid {
namespace {

enum class Side : signed char { back = -1, in_plane = 0, front = 1 };

Side side_of(double height, double thickness) {
  if (height > thickness) return Side::front;
  return height < -thickness ? Side::back : Side::in_plane;
}

// Corners in the plane stay there only where the outline changes sides, one of them each time: runs of them
// would otherwise belong to both parts. `sides` has corners on both sides.
void settle_corners_in_plane(std::span<const double> heights, std::vector<Side>& sides) {
  const std::size_t count = sides.size();
  std::size_t first = 0;
  while (sides[first] == Side::in_plane) ++first;
  for (std::size_t begin = first; begin < first + count;) {
    std::size_t end = begin + 1;
    while (sides[end % count] == Side::in_plane) ++end;
    const Side before = sides[begin % count];
    const Side after = sides[end % count];
    std::size_t nearest = begin + 1;
    for (std::size_t i = begin + 1; i < end; ++i) {
      if (std::fabs(heights[i % count]) < std::fabs(heights[nearest % count])) nearest = i;
    }
    for (std::size_t i = begin + 1; i < end; ++i) {
      if (before == after || i != nearest) sides[i % count] = i < nearest ? before : after;
    }
    begin = end;
  }
}

}  // namespace

bool crosses(std::span<const double> heights, double thickness) {
  const auto [lowest, highest] = std::minmax_element(heights.begin(), heights.end());
  return *lowest<-thickness&& * highest> thickness;
}

void cut_convex(std::span<const std::uint32_t> corners, std::span<const double> heights, double thickness,
                const CutEdge& cut_edge, std::vector<std::uint32_t>& front,
                std::vector<std::uint32_t>& back) {
  std::vector<Side> sides;
  sides.reserve(corners.size());
  for (const double height : heights) sides.push_back(side_of(height, thickness));
  settle_corners_in_plane(heights, sides);
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const std::size_t next = (i + 1) % corners.size();
    if (sides[i] != Side::back) front.push_back(corners[i]);
    if (sides[i] != Side::front) back.push_back(corners[i]);
    if (sides[i] == sides[next] || sides[i] == Side::in_plane || sides[next] == Side::in_plane) continue;
    const std::uint32_t cut = cut_edge(corners[i], corners[next], heights[i], heights[next]);
    front.push_back(cut);
    back.push_back(cut);
  }
}

}  // namespace pellucid
