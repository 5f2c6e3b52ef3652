// A tree of boxes: see box_tree.h.
#include "mesh/box_tree.h"

namespace pellucid {
namespace {

constexpr std::uint32_t kLeafSize = 4;

double component(const Vec3d& v, int axis) {
  return axis == 0 ? v.x : axis == 1 ? v.y : v.z;
}

int longest_axis(const Box3& box) {
  const Vec3d size = box.high - box.low;
  if (size.x >= size.y && size.x >= size.z) return 0;
  return size.y >= size.z ? 1 : 2;
}

}  // namespace

BoxTree::BoxTree(std::span<const Box3> boxes) : boxes_(boxes), ids_(boxes.size()) {
  std::iota(ids_.begin(), ids_.end(), 0U);
  if (boxes.empty()) return;
  const auto count = static_cast<std::uint32_t>(boxes.size());
  nodes_.push_back({box_of(0, count), 0, 0, count});
  // Children stand behind their parents: one pass over a growing list.
  for (std::uint32_t node = 0; node < nodes_.size(); ++node) {
    if (nodes_[node].count > kLeafSize) halve(node);
  }
}

Box3 BoxTree::box_of(std::uint32_t first, std::uint32_t count) const {
  Box3 box = boxes_[ids_[first]];
  for (std::uint32_t i = first + 1; i < first + count; ++i) {
    box.include(boxes_[ids_[i]].low);
    box.include(boxes_[ids_[i]].high);
  }
  return box;
}

void BoxTree::halve(std::uint32_t node) {
  const std::uint32_t first = nodes_[node].first;
  const std::uint32_t count = nodes_[node].count;
  const std::uint32_t half = count / 2;
  const int axis = longest_axis(nodes_[node].box);
  const auto middle = [&](std::uint32_t id) {
    return component(boxes_[id].low, axis) + component(boxes_[id].high, axis);
  };
  // The number breaks ties, so that the tree is the same everywhere.
  std::nth_element(ids_.begin() + first, ids_.begin() + first + half, ids_.begin() + first + count,
                   [&](std::uint32_t a, std::uint32_t b) {
                     const double key_a = middle(a);
                     const double key_b = middle(b);
                     return key_a < key_b || (key_a == key_b && a < b);
                   });
  nodes_[node].left = static_cast<std::uint32_t>(nodes_.size());
  nodes_.push_back({box_of(first, half), 0, first, half});
  nodes_.push_back({box_of(first + half, count - half), 0, first + half, count - half});
}

}  // namespace pellucid
