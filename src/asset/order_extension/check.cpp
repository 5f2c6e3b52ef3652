// Implements check_orders() of order_extension.h: checks the order sets that a caller wants to write.
#include <algorithm>
#include <cmath>
#include <functional>
#include <set>

#include "asset/formats/text_cursor.h"
#include "asset/order_extension/order_extension.h"

namespace pellucid {
namespace {

class OrderCheck {
 public:
  OrderCheck(const Model& model, const Primitive& primitive, const OrderSet& set)
      : model_(model), primitive_(primitive), set_(set) {}

  void run() const {
    if (!primitive_.triangles) fail("it is not made of triangles");
    check_partition();
    check_cells(set_.cell_orders, 1);
    for (const NodeSequence& order : set_.orders) check_order(order);
    check_base();
    if (set_.purpose == OrderPurpose::overdraw) {
      check_overdraw();
    } else if (!set_.patch_offsets.empty() || !set_.model_ranks.empty() || !set_.animations.empty()) {
      fail("patches, model ranks and key frames are for overdraw orders only");
    }
  }

 private:
  [[noreturn]] void fail(const std::string& reason) const {
    throw Error(ErrorKind::bad_argument, "orders of primitive " + in_quotes(primitive_.name) + ": " + reason);
  }

  void check_partition() const {
    if (set_.partition.level > kMaxPartitionLevel) fail("the partition's level is above 5");
    const Vec3d& c = set_.sphere.center;
    if (!std::isfinite(c.x + c.y + c.z + set_.sphere.radius) || set_.sphere.radius < 0) {
      fail("the bounding sphere is not finite");
    }
    if (!std::isfinite(set_.valid_from) || set_.valid_from < 0 || !(set_.valid_to >= set_.valid_from)) {
      fail("the valid distances are not a range");
    }
  }

  void check_cells(const std::vector<std::uint32_t>& cell_orders, std::uint64_t rows) const {
    const std::uint64_t quads = std::uint64_t{1} << (2 * set_.partition.level);  // 4^level
    const bool triangles = has_triangle_cells(set_.partition);
    const std::uint64_t expected = rows * (triangles ? 20 * quads : 10 * quads + 2);
    if (cell_orders.size() != expected) {
      fail("there are " + std::to_string(cell_orders.size()) + " cells, the partition has " +
           std::to_string(expected));
    }
    for (const std::uint32_t order : cell_orders) {
      if (order >= set_.orders.size())
        fail("a cell names order " + std::to_string(order) + ", which does not exist");
    }
  }

  void check_order(const NodeSequence& order) const {
    std::vector<bool> seen(2 * primitive_.mesh.triangles.size(), false);
    for (const NodeId node : order) {
      if (node >= seen.size())
        fail("an order draws triangle " + std::to_string(triangle_of(node)) + ", which does not exist");
      if (seen[node]) fail("an order draws triangle " + std::to_string(triangle_of(node)) + " twice");
      if (is_flipped(node) && set_.facing == Facing::single)
        fail("the facing is single, but an order holds a flipped triangle");
      seen[node] = true;
    }
  }

  void check_base() const {
    std::vector<bool> seen(primitive_.mesh.triangles.size(), false);
    for (const std::uint32_t triangle : set_.base_sequence) {
      if (triangle >= seen.size() || seen[triangle])
        fail("the base sequence is not a list of distinct triangles");
      seen[triangle] = true;
    }
  }

  void check_overdraw() const {
    if (set_.facing != Facing::single) fail("overdraw orders hold triangles as stored: facing is single");
    if (!set_.model_ranks.empty() && set_.model_ranks.size() != set_.orders.size()) {
      fail("there are " + std::to_string(set_.model_ranks.size()) + " model ranks for " +
           std::to_string(set_.orders.size()) + " orders");
    }
    check_permutations();
    if (!set_.patch_offsets.empty()) check_patches();
    for (const KeyFrameTable& table : set_.animations) check_key_frames(table);
    check_animations_differ();
  }

  // Checks that every order is a permutation. check_order() and check_base() have excluded triangles that
  // occur twice.
  void check_permutations() const {
    std::vector<bool> in_base(primitive_.mesh.triangles.size(), false);
    for (const std::uint32_t triangle : set_.base_sequence) in_base[triangle] = true;
    for (const NodeSequence& order : set_.orders) {
      bool same = order.size() == set_.base_sequence.size();
      for (const NodeId node : order) same = same && in_base[triangle_of(node)];
      if (!same) fail("an overdraw order does not draw every triangle of the base sequence once");
    }
  }

  void check_patches() const {
    const std::vector<std::uint32_t>& offsets = set_.patch_offsets;
    const bool spans = offsets.front() == 0 && offsets.back() == set_.base_sequence.size();
    if (!spans ||
        std::adjacent_find(offsets.begin(), offsets.end(), std::greater_equal<>()) != offsets.end()) {
      fail("the patch offsets do not rise strictly from 0 to the length of the base sequence");
    }
    // A triangle that does not follow its predecessor in the base order must begin a patch.
    std::vector<std::uint32_t> position(primitive_.mesh.triangles.size(), 0);
    for (std::uint32_t i = 0; i < set_.base_sequence.size(); ++i) position[set_.base_sequence[i]] = i;
    std::vector<bool> begins_patch(set_.base_sequence.size() + 1, false);
    for (const std::uint32_t offset : offsets) begins_patch[offset] = true;
    for (const NodeSequence& order : set_.orders) {
      std::uint32_t next = 0;
      for (const NodeId node : order) {
        const std::uint32_t at = position[triangle_of(node)];
        if (at != next && !(begins_patch[at] && begins_patch[next])) {
          fail("an overdraw order is not a permutation of whole patches");
        }
        next = at + 1;
      }
    }
  }

  // Times and spheres are stored as 32-bit floats, and are checked as such.
  void check_key_frames(const KeyFrameTable& table) const {
    const std::string name = "key frames of animation " + std::to_string(table.animation) + ": ";
    if (table.animation >= model_.animation_names.size()) fail(name + "the model has no such animation");
    if (table.times.empty() || table.spheres.size() != table.times.size()) {
      fail(name + std::to_string(table.times.size()) + " times and " + std::to_string(table.spheres.size()) +
           " spheres");
    }
    for (std::size_t i = 0; i < table.times.size(); ++i) {
      const auto time = static_cast<float>(table.times[i]);
      if (!std::isfinite(time) || (i > 0 && !(time > static_cast<float>(table.times[i - 1])))) {
        fail(name + "the times are not finite and strictly increasing");
      }
      const BoundingSphere& sphere = table.spheres[i];
      const Vec3f center = to_float(sphere.center);
      if (!std::isfinite(center.x) || !std::isfinite(center.y) || !std::isfinite(center.z) ||
          !std::isfinite(static_cast<float>(sphere.radius)) || sphere.radius < 0) {
        fail(name + "a sphere is not finite, or its radius is negative");
      }
    }
    check_cells(table.cell_orders, table.times.size());
  }

  void check_animations_differ() const {
    std::set<std::uint32_t> seen;
    for (const KeyFrameTable& table : set_.animations) {
      if (!seen.insert(table.animation).second) {
        fail("animation " + std::to_string(table.animation) + " has two tables of key frames");
      }
    }
  }

  const Model& model_;
  const Primitive& primitive_;
  const OrderSet& set_;
};

void check_record(const OrderErrorRecord& record) {
  bool sound = std::isfinite(record.ipr_mean + record.ipr_max) && !std::isnan(record.psnr_mean);
  for (const auto& entry : record.by_distance)
    sound &= std::isfinite(entry.ipr) && !std::isnan(entry.distance);
  if (!sound) throw Error(ErrorKind::bad_argument, "the error record of an order set is not finite");
}

}  // namespace

void check_orders(const Model& model, const std::vector<OrderedPrimitive>& ordered) {
  std::vector<bool> seen(model.primitives.size(), false);
  for (const OrderedPrimitive& entry : ordered) {
    if (entry.primitive >= seen.size()) {
      throw Error(ErrorKind::bad_argument, "orders for primitive " + std::to_string(entry.primitive) +
                                               " of " + std::to_string(seen.size()));
    }
    if (seen[entry.primitive]) {
      throw Error(ErrorKind::bad_argument, "two order sets for primitive " + std::to_string(entry.primitive));
    }
    seen[entry.primitive] = true;
    OrderCheck(model, model.primitives[entry.primitive], entry.orders).run();
    if (entry.error) check_record(*entry.error);
  }
}

}  // namespace pellucid
