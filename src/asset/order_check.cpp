// Checks of a caller's orders: see order_check.h.
#include "order_check.h"

#include <cmath>

namespace pellucid {
namespace {

constexpr std::uint32_t kMaxLevel = 5;  // of PartitionSpec

class OrderCheck {
 public:
  OrderCheck(const Primitive& primitive, const OrderSet& set) : primitive_(primitive), set_(set) {}

  void run() const {
    if (!primitive_.triangles) fail("it is not made of triangles");
    check_partition();
    check_cells();
    for (const NodeSequence& order : set_.orders) check_order(order);
    check_base();
  }

 private:
  [[noreturn]] void fail(const std::string& reason) const {
    throw Error(ErrorKind::bad_argument, "orders of primitive \"" + primitive_.name + "\": " + reason);
  }

  void check_partition() const {
    if (set_.partition.level > kMaxLevel) fail("the partition's level is above 5");
    const Vec3d& c = set_.sphere.center;
    if (!std::isfinite(c.x + c.y + c.z + set_.sphere.radius) || set_.sphere.radius < 0) {
      fail("the bounding sphere is not finite");
    }
    if (!std::isfinite(set_.valid_from) || set_.valid_from < 0 || !(set_.valid_to >= set_.valid_from)) {
      fail("the valid distances are no range");
    }
  }

  void check_cells() const {
    const std::uint64_t quads = std::uint64_t{1} << (2 * set_.partition.level);  // 4^level
    const bool triangles = has_triangle_cells(set_.partition);
    const std::uint64_t expected = triangles ? 20 * quads : 10 * quads + 2;
    if (set_.cell_orders.size() != expected) {
      fail("there are " + std::to_string(set_.cell_orders.size()) + " cells, the partition has " +
           std::to_string(expected));
    }
    for (const std::uint32_t order : set_.cell_orders) {
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
        fail("single facing, but an order holds a flipped triangle");
      seen[node] = true;
    }
  }

  void check_base() const {
    std::vector<bool> seen(primitive_.mesh.triangles.size(), false);
    for (const std::uint32_t triangle : set_.base_sequence) {
      if (triangle >= seen.size() || seen[triangle])
        fail("the base sequence is no list of distinct triangles");
      seen[triangle] = true;
    }
  }

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
    OrderCheck(model.primitives[entry.primitive], entry.orders).run();
    if (entry.error) check_record(*entry.error);
  }
}

}  // namespace pellucid
