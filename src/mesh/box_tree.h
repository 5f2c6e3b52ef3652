// Internal to the module `mesh`: a binary tree of axis-aligned boxes, for all that overlap a given one.
#pragma once

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

#include "pellucid/base.h"

namespace pellucid {

struct Box3 {
  Vec3d low, high;

  [[nodiscard]] bool overlaps(const Box3& b) const {
    return low.x <= b.high.x && b.low.x <= high.x && low.y <= b.high.y && b.low.y <= high.y &&
           low.z <= b.high.z && b.low.z <= high.z;
  }
  void include(const Vec3d& p) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
};

// Halved at the median of the middles along the longest side. O(n log n) to build, 32-bit ids.
class BoxTree {
 public:
  explicit BoxTree(std::span<const Box3> boxes);

  // Calls visit(i) for every box that overlaps `query`, in an order that depends on the boxes alone.
  template <class Visit>
  void for_each_overlap(const Box3& query, const Visit& visit) const {
    if (nodes_.empty()) return;
    std::vector<std::uint32_t> stack{0};
    while (!stack.empty()) {
      const Node& node = nodes_[stack.back()];
      stack.pop_back();
      if (!node.box.overlaps(query)) continue;
      if (node.left != 0) {
        stack.push_back(node.left + 1);
        stack.push_back(node.left);
        continue;
      }
      for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
        if (boxes_[ids_[i]].overlaps(query)) visit(ids_[i]);
      }
    }
  }

 private:
  struct Node {
    Box3 box;
    std::uint32_t left = 0;  // children are left and left + 1; 0: a leaf
    std::uint32_t first = 0, count = 0;
  };
  [[nodiscard]] Box3 box_of(std::uint32_t first, std::uint32_t count) const;
  void halve(std::uint32_t node);

  std::span<const Box3> boxes_;
  std::vector<std::uint32_t> ids_;
  std::vector<Node> nodes_;
};

}  // namespace pellucid
