// Convex polygons to triangles: see triangulate.h.
#include "mesh/triangulate.h"

#include <algorithm>
#include <limits>

namespace pellucid {
namespace {

constexpr std::size_t kMostByProgram = 32;

using Ids = std::vector<std::uint32_t>;

class Triangulation {
 public:
  Triangulation(std::span<const Vec3d> corners, const Vec3d& normal,
                std::vector<std::array<std::uint32_t, 3>>& triangles)
      : corners_(corners), normal_(normal), triangles_(triangles) {}

  void add(const Ids& polygon) {
    if (polygon.size() > kMostByProgram) {
      halve(polygon);
    } else {
      add_best(polygon);
    }
  }

 private:
  // Height over the longest side; negative where the corners turn the wrong way.
  [[nodiscard]] double thickness(std::uint32_t a, std::uint32_t b, std::uint32_t c) const {
    const Vec3d ab = corners_[b] - corners_[a];
    const Vec3d ac = corners_[c] - corners_[a];
    const Vec3d bc = corners_[c] - corners_[b];
    const double longest = std::max({dot(ab, ab), dot(ac, ac), dot(bc, bc)});
    return longest > 0 ? dot(cross(ab, ac), normal_) / std::sqrt(longest) : 0;
  }

  // Dynamic programming over the chains of corners first .. last, closed by the diagonal between them.
  void add_best(const Ids& polygon) {
    const std::size_t n = polygon.size();
    std::vector<double> best(n * n, std::numeric_limits<double>::infinity());
    std::vector<std::size_t> apex(n * n, 0);
    for (std::size_t span = 2; span < n; ++span) {
      for (std::size_t first = 0; first + span < n; ++first) {
        const std::size_t last = first + span;
        double& value = best[first * n + last];
        value = -std::numeric_limits<double>::infinity();
        for (std::size_t k = first + 1; k < last; ++k) {
          const double worst = std::min({thickness(polygon[first], polygon[k], polygon[last]),
                                         best[first * n + k], best[k * n + last]});
          if (worst > value) {
            value = worst;
            apex[first * n + last] = k;
          }
        }
      }
    }
    std::vector<std::pair<std::size_t, std::size_t>> chains{{0, n - 1}};
    while (!chains.empty()) {
      const auto [first, last] = chains.back();
      chains.pop_back();
      if (last - first < 2) continue;
      const std::size_t k = apex[first * n + last];
      triangles_.push_back({polygon[first], polygon[k], polygon[last]});
      chains.emplace_back(k, last);
      chains.emplace_back(first, k);
    }
  }

  // Cut along the diagonal between opposite corners that leaves most width on its narrower side.
  void halve(const Ids& polygon) {
    const std::size_t n = polygon.size();
    const std::size_t half = n / 2;
    std::size_t best = 0;
    double best_width = -1;
    for (std::size_t i = 0; i < n - half; ++i) {
      double widths[2] = {0, 0};
      for (std::size_t k = 0; k < n; ++k) {
        const double width = std::fabs(thickness(polygon[i], polygon[i + half], polygon[k]));
        double& side = widths[k > i && k < i + half ? 0 : 1];
        side = std::max(side, width);
      }
      if (std::min(widths[0], widths[1]) > best_width) {
        best_width = std::min(widths[0], widths[1]);
        best = i;
      }
    }
    const auto at = [&](std::size_t i) { return polygon.begin() + static_cast<std::ptrdiff_t>(i); };
    Ids rest(polygon.begin(), at(best + 1));
    rest.insert(rest.end(), at(best + half), polygon.end());
    add({at(best), at(best + half + 1)});
    add(rest);
  }

  std::span<const Vec3d> corners_;
  Vec3d normal_;
  std::vector<std::array<std::uint32_t, 3>>& triangles_;
};

}  // namespace

void triangulate_convex(std::span<const Vec3d> corners, const Vec3d& normal,
                        std::vector<std::array<std::uint32_t, 3>>& triangles) {
  Ids polygon(corners.size());
  for (std::uint32_t i = 0; i < polygon.size(); ++i) polygon[i] = i;
  Triangulation(corners, normal, triangles).add(polygon);
}

}  // namespace pellucid
