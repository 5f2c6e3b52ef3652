// Implements read_order_extension() of order_extension.h: reads and checks the order extension.
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <optional>
#include <tuple>
#include <vector>

#include "asset/formats/text_cursor.h"
#include "asset/order_extension/order_extension.h"
#include "pellucid/sequencing.h"

namespace pellucid {
namespace {

// Returns the lexicographically smallest of the three rotations. It is unique, also if corners repeat.
Triangle smallest_rotation(const Triangle& t) {
  return std::min({t, Triangle{t[1], t[2], t[0]}, Triangle{t[2], t[0], t[1]}});
}

// Finds the nodes (facings of triangles) that index triples draw. (a b c), (b c a) and (c a b) are the same
// facing. Building the table for T triangles takes O(T log T), a look-up at most O(log T).
class FacingTable {
 public:
  // With Facing::single the table holds the stored facings only.
  FacingTable(const Mesh& mesh, Facing facing) {
    const NodeId step = facing == Facing::single ? 2 : 1;
    const auto node_end = static_cast<NodeId>(2 * mesh.triangles.size());

    // Counting sort by first corner.
    offsets_.assign(mesh.positions.size() + 1, 0);
    for (NodeId node = 0; node < node_end; node += step)
      ++offsets_[smallest_rotation(corners_of(mesh, node))[0] + 1];
    for (std::size_t v = 1; v < offsets_.size(); ++v) offsets_[v] += offsets_[v - 1];
    entries_.resize(offsets_.back());
    std::vector<std::size_t> next(offsets_.begin(), offsets_.end() - 1);
    for (NodeId node = 0; node < node_end; node += step) {
      const Triangle corners = smallest_rotation(corners_of(mesh, node));
      entries_[next[corners[0]]++] = {corners[1], corners[2], node};
    }

    const auto key = [](const Entry& e) {
      return std::tuple(e.second, e.third, is_flipped(e.node), triangle_of(e.node));
    };
    for (std::size_t v = 0; v + 1 < offsets_.size(); ++v) {
      std::sort(entries_.begin() + static_cast<std::ptrdiff_t>(offsets_[v]),
                entries_.begin() + static_cast<std::ptrdiff_t>(offsets_[v + 1]),
                [&](const Entry& a, const Entry& b) { return key(a) < key(b); });
    }
    taken_.resize(entries_.size());
  }

  // Begins the next order: forgets which nodes were taken.
  void start_order() {
    for (const std::size_t entry : touched_) taken_[entry] = 0;
    touched_.clear();
  }
  // Returns the next node that draws `corners` and was not taken in this order yet, or nothing if none is
  // left. Several nodes may have the same triple: duplicates, and the two facings of coincident triangles.
  // They come in the order of their triangles, stored facings before flipped ones.
  std::optional<NodeId> take(const Triangle& corners) {
    const Triangle wanted = smallest_rotation(corners);
    if (wanted[0] + std::size_t{1} >= offsets_.size()) return std::nullopt;
    const auto begin = entries_.begin() + static_cast<std::ptrdiff_t>(offsets_[wanted[0]]);
    const auto end = entries_.begin() + static_cast<std::ptrdiff_t>(offsets_[wanted[0] + 1]);
    const auto first = std::lower_bound(begin, end, wanted, [](const Entry& e, const Triangle& t) {
      return std::tuple(e.second, e.third) < std::tuple(t[1], t[2]);
    });
    if (first == end) return std::nullopt;
    std::uint32_t& taken = taken_[static_cast<std::size_t>(first - entries_.begin())];
    if (taken >= end - first) return std::nullopt;
    const Entry& next = *(first + taken);
    if (next.second != wanted[1] || next.third != wanted[2]) return std::nullopt;
    if (taken++ == 0) touched_.push_back(static_cast<std::size_t>(first - entries_.begin()));
    return next.node;
  }

 private:
  struct Entry {
    std::uint32_t second, third;  // after the smallest rotation
    NodeId node;
  };
  std::vector<std::size_t> offsets_;  // first corner -> its entries; vertices + 1
  std::vector<Entry> entries_;        // sorted by (second, third, flipped, triangle) within a first corner
  std::vector<std::uint32_t> taken_;  // at the first entry of equal triples: the number of taken ones
  std::vector<std::size_t> touched_;  // the entries of taken_ that are not zero
};

constexpr std::uint64_t kMaxSampleLevel = 4;

constexpr std::uint64_t triangle_count(std::uint64_t level) {
  return std::uint64_t{20} << (2 * level);
}

class OrderExtensionReader {
 public:
  OrderExtensionReader(const Fields& extension, const Mesh& mesh, AccessorReader& accessors,
                       std::uint64_t animations)
      : extension_(extension), mesh_(mesh), accessors_(accessors), animations_(animations) {}

  StoredOrders read() {
    const std::uint64_t version = extension_.index("version");
    if (version != kOrderExtensionVersion) {
      extension_.fail("version " + std::to_string(version) + " is not known; a newer pellucid may read it");
    }
    StoredOrders stored;
    read_purpose(stored.orders);
    read_partition(stored.orders);
    read_orders(stored.orders);
    stored.orders.cell_orders = read_cell_orders(extension_, stored.orders, 1);
    read_key_frames(stored.orders);
    const std::uint64_t fallback = extension_.index_or("fallbackOrder", 0);
    if (fallback >= stored.orders.orders.size()) extension_.fail("fallbackOrder names no order");
    read_base(stored.orders);
    stored.error = read_error();
    return stored;
  }

 private:
  // Returns true for `yes` and false for `no`; fails for any other value.
  bool choose(const char* key, const char* yes, const char* no) const {
    return choose(extension_, key, yes, no);
  }

  static bool choose(const Fields& fields, const char* key, const char* yes, const char* no) {
    const std::string value = fields.text(key);
    if (value != yes && value != no) {
      fields.fail(std::string(key) + " is " + in_quotes(value) + ", neither " + yes + " nor " + no);
    }
    return value == yes;
  }

  // Overdraw orders are drawn as they are stored, so their sorting and facing are fixed.
  void read_purpose(OrderSet& set) {
    const std::string purpose = extension_.text_or("purpose", "transparency");
    if (purpose != "transparency" && purpose != "overdraw") {
      extension_.fail("purpose " + in_quotes(purpose) + " is not known");
    }
    overdraw_ = purpose == "overdraw";
    set.purpose = overdraw_ ? OrderPurpose::overdraw : OrderPurpose::transparency;
    reversed_ = choose("sorting", "backToFront", "frontToBack");
    set.facing = choose("facing", "duplicated", "single") ? Facing::duplicated : Facing::single;
    if (overdraw_ && reversed_) extension_.fail("sorting of overdraw orders must be frontToBack");
    if (overdraw_ && set.facing != Facing::single) {
      extension_.fail("facing of overdraw orders must be single");
    }
    if (!overdraw_ && extension_.has("keyframes")) extension_.fail("only overdraw orders have keyframes");
  }

  // The coverage is informative. An unknown value counts as samples.
  static PartitionKind coverage_of(const Fields& partition) {
    const std::string coverage = partition.text_or("coverage", "samples");
    if (coverage == "triangle") return PartitionKind::view_triangles;
    if (coverage == "region") return PartitionKind::view_regions;
    return PartitionKind::sampled_triangles;
  }

  void read_partition(OrderSet& set) const {
    const Fields partition = extension_.object("partition");
    if (const std::string type = partition.text("type"); type != "icosphere") {
      partition.fail("type " + in_quotes(type) + " is not known");
    }
    const bool triangles = choose(partition, "cells", "triangles", "vertices");
    const std::uint64_t level = partition.index("level");
    const std::uint64_t sample_level = triangles ? partition.index_or("sampleLevel", 0) : 0;
    if (level > kMaxPartitionLevel) partition.fail("level " + std::to_string(level) + " is above 5");
    if (sample_level > kMaxSampleLevel)
      partition.fail("sampleLevel " + std::to_string(sample_level) + " is above 4");
    set.partition = {triangles ? coverage_of(partition) : PartitionKind::viewpoints,
                     static_cast<std::uint32_t>(level), static_cast<std::uint32_t>(sample_level)};
    if (is_continuous(set.partition)) set.partition.sample_level = kSolidSampleLevel;

    const std::vector<double> center = partition.numbers("center", 3);
    if (center.empty()) partition.fail("center is missing");
    set.sphere = {{center[0], center[1], center[2]}, partition.number("radius")};
    set.valid_from = partition.number("minDistance");
    set.valid_to = partition.number_or("maxDistance", kInfiniteDistance);
    if (set.sphere.radius < 0) partition.fail("radius is negative");
    if (set.valid_from < 0 || set.valid_to < set.valid_from)
      partition.fail("minDistance to maxDistance is not a range");
  }

  void read_orders(OrderSet& set) {
    const std::uint64_t count = extension_.size("orders");
    if (count == 0) extension_.fail("it has no orders");
    // There can be at most one order per cell, plus the fallback, except with key frames.
    if (!overdraw_ && count > triangle_count(set.partition.level) + 1)
      extension_.fail("it has more orders than view cells");
    std::optional<FacingTable> table;
    for (std::uint64_t i = 0; i < count; ++i) {
      const Fields order = extension_.element("orders", i);
      NodeSequence nodes;
      if (const auto patches = order.find_index("patches")) {
        nodes = nodes_from_patches(order, *patches, set.facing);
      } else if (const auto indices = order.find_index("indices")) {
        if (!table) table.emplace(mesh_, set.facing);
        nodes = nodes_from_indices(order, *indices, *table);
        whole_patches_ = false;
      }  // Neither: the order draws nothing, because no accessor may be empty.
      set.orders.push_back(std::move(nodes));
      if (const auto rank = order.find_index("rank")) set.model_ranks.push_back(rank_of(order, *rank));
    }
    if (!set.model_ranks.empty() && set.model_ranks.size() != count) {
      extension_.fail("some orders have a rank and some have none");
    }
  }

  [[nodiscard]] std::uint32_t rank_of(const Fields& order, std::uint64_t rank) const {
    if (!overdraw_) order.fail("only overdraw orders have a rank");
    if (rank > std::numeric_limits<std::uint32_t>::max()) order.fail("its rank is above 2^32 - 1");
    return static_cast<std::uint32_t>(rank);
  }

  // Checked before anything is read. A valid order draws no node twice, so its length is limited.
  void check_length(const Fields& order, std::uint64_t accessor, std::uint64_t per_node) const {
    const std::uint64_t longest = 2 * mesh_.triangles.size() * per_node;
    if (accessors_.count(accessor) > longest) order.fail("it is longer than all facings of all triangles");
  }

  NodeSequence nodes_from_indices(const Fields& order, std::uint64_t accessor, FacingTable& table) {
    check_length(order, accessor, 3);
    const std::vector<std::uint32_t> indices = accessors_.read_scalars(accessor);
    if (indices.size() % 3 != 0) {
      order.fail("its " + std::to_string(indices.size()) + " indices are no multiple of 3");
    }
    NodeSequence nodes(indices.size() / 3);
    table.start_order();
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      const std::size_t at = 3 * (reversed_ ? nodes.size() - 1 - i : i);
      const Triangle corners{indices[at], indices[at + 1], indices[at + 2]};
      const auto node = table.take(corners);
      if (!node) {
        order.fail("triangle " + std::to_string(at / 3) + " (" + std::to_string(corners[0]) + " " +
                   std::to_string(corners[1]) + " " + std::to_string(corners[2]) +
                   ") is no facing of a triangle of the primitive, or comes too often");
      }
      nodes[i] = *node;
    }
    return nodes;
  }

  // Returns the patch offsets: patch p has the triangles patchOffsets[p] to patchOffsets[p + 1] - 1. Without
  // patchOffsets, every triangle is a patch.
  const std::vector<std::uint32_t>& patch_offsets() {
    if (!patch_offsets_.empty()) return patch_offsets_;
    const std::size_t triangles = mesh_.triangles.size();
    if (const auto accessor = extension_.find_index("patchOffsets")) {
      if (accessors_.count(*accessor) > triangles + 1)
        extension_.fail("patchOffsets has more patches than triangles");
      patch_offsets_ = accessors_.read_scalars(*accessor);
      if (overdraw_) {
        check_overdraw_patches();
        return patch_offsets_;
      }
      const bool spans =
          !patch_offsets_.empty() && patch_offsets_.front() == 0 && patch_offsets_.back() == triangles;
      if (!spans || !std::is_sorted(patch_offsets_.begin(), patch_offsets_.end())) {
        extension_.fail("patchOffsets does not rise from 0 to the number of triangles");
      }
    } else {
      patch_offsets_.resize(triangles + 1);
      std::iota(patch_offsets_.begin(), patch_offsets_.end(), 0U);
    }
    return patch_offsets_;
  }

  // Triangles after the last patch are in no order.
  void check_overdraw_patches() const {
    const bool spans = !patch_offsets_.empty() && patch_offsets_.front() == 0 &&
                       patch_offsets_.back() <= mesh_.triangles.size();
    const auto falls =
        std::adjacent_find(patch_offsets_.begin(), patch_offsets_.end(), std::greater_equal<>());
    if (!spans || falls != patch_offsets_.end()) {
      extension_.fail("patchOffsets does not rise strictly from 0 to at most the number of triangles");
    }
  }

  NodeSequence nodes_from_patches(const Fields& order, std::uint64_t accessor, Facing facing) {
    check_length(order, accessor, 1);
    const std::vector<std::uint32_t>& offsets = patch_offsets();
    const std::uint64_t patches = offsets.size() - 1;
    std::vector<bool> drawn(2 * mesh_.triangles.size(), false);
    NodeSequence nodes;
    for (const std::uint32_t id : accessors_.read_scalars(accessor)) {
      const bool flipped = id >= patches;
      if (id >= 2 * patches || (flipped && facing == Facing::single)) {
        order.fail("patch id " + std::to_string(id) + " is out of range: there are " +
                   std::to_string(patches));
      }
      const std::uint64_t patch = flipped ? id - patches : id;
      // A few ids of large patches can become many triangles.
      if (offsets[patch + 1] > offsets[patch] + 1)
        accessors_.charge(order, offsets[patch + 1] - offsets[patch] - 1);
      for (std::uint32_t triangle = offsets[patch]; triangle < offsets[patch + 1]; ++triangle) {
        const NodeId node = node_of(triangle, flipped);
        if (drawn[node]) order.fail("patch id " + std::to_string(id) + " comes twice");
        drawn[node] = true;
        nodes.push_back(node);
      }
    }
    if (reversed_) std::reverse(nodes.begin(), nodes.end());
    return nodes;
  }

  // Reads the table `cellOrders` of `owner`, one row for each key frame.
  std::vector<std::uint32_t> read_cell_orders(const Fields& owner, const OrderSet& set, std::uint64_t rows) {
    const std::uint64_t accessor = owner.index("cellOrders");
    const bool per_corner = !has_triangle_cells(set.partition);
    const std::uint64_t expected = rows * triangle_count(set.partition.level) * (per_corner ? 3 : 1);
    if (accessors_.count(accessor) != expected) {
      owner.fail("cellOrders has " + std::to_string(accessors_.count(accessor)) +
                 " entries, the partition needs " + std::to_string(expected));
    }
    std::vector<std::uint32_t> stored = accessors_.read_scalars(accessor);
    for (std::size_t cell = 0; cell < stored.size(); ++cell) {
      if (stored[cell] >= set.orders.size()) {
        owner.fail("cellOrders[" + std::to_string(cell) + "] names order " + std::to_string(stored[cell]) +
                   " of " + std::to_string(set.orders.size()));
      }
    }
    return per_corner ? orders_of_vertices(owner, stored, set.partition.level) : stored;
  }

  // Converts one order per corner of each triangle into one per vertex, row by row. All corners at a vertex
  // must agree.
  static std::vector<std::uint32_t> orders_of_vertices(const Fields& owner,
                                                       const std::vector<std::uint32_t>& corners,
                                                       std::uint32_t level) {
    constexpr std::uint32_t kUnset = std::numeric_limits<std::uint32_t>::max();
    const Icosphere sphere = make_icosphere(level);
    const std::size_t row_corners = 3 * sphere.triangles.size();
    std::vector<std::uint32_t> orders(corners.size() / row_corners * sphere.vertices.size(), kUnset);
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const std::size_t row = i / row_corners;
      const std::size_t corner = i % row_corners;
      std::uint32_t& order = orders[row * sphere.vertices.size() + sphere.triangles[corner / 3][corner % 3]];
      if (order != kUnset && order != corners[i]) {
        owner.fail("cellOrders[" + std::to_string(i) + "] differs from another corner at the same vertex");
      }
      order = corners[i];
    }
    return orders;
  }

  void read_key_frames(OrderSet& set) {
    for (std::uint64_t i = 0; i < extension_.size("keyframes"); ++i) {
      const Fields fields = extension_.element("keyframes", i);
      KeyFrameTable table;
      table.animation = animation_of(fields, set);
      read_times(fields, table);
      read_spheres(fields, table);
      table.cell_orders = read_cell_orders(fields, set, table.times.size());
      set.animations.push_back(std::move(table));
    }
  }

  [[nodiscard]] std::uint32_t animation_of(const Fields& fields, const OrderSet& set) const {
    const std::uint64_t animation = fields.index("animation");
    if (animation >= animations_) {
      fields.fail("animation " + std::to_string(animation) + " does not exist: there are " +
                  std::to_string(animations_));
    }
    for (const KeyFrameTable& other : set.animations) {
      if (other.animation == animation)
        fields.fail("animation " + std::to_string(animation) + " has two tables");
    }
    return static_cast<std::uint32_t>(animation);
  }

  void read_times(const Fields& fields, KeyFrameTable& table) {
    for (const float time : accessors_.read_floats(fields.index("times"), 1)) {
      const bool later = table.times.empty() || time > table.times.back();
      if (!std::isfinite(time) || !later) fields.fail("times are not finite and strictly increasing");
      table.times.push_back(time);
    }
    if (table.times.empty()) fields.fail("times are empty");
  }

  void read_spheres(const Fields& fields, KeyFrameTable& table) {
    const std::vector<float> values = accessors_.read_floats(fields.index("spheres"), 4);
    if (values.size() != 4 * table.times.size()) {
      fields.fail("there are " + std::to_string(values.size() / 4) + " spheres for " +
                  std::to_string(table.times.size()) + " times");
    }
    for (std::size_t i = 0; i < values.size(); i += 4) {
      const BoundingSphere sphere{{values[i], values[i + 1], values[i + 2]}, values[i + 3]};
      if (!std::isfinite(sphere.center.x + sphere.center.y + sphere.center.z + sphere.radius) ||
          sphere.radius < 0) {
        fields.fail("spheres[" + std::to_string(i / 4) + "] is not finite, or its radius is negative");
      }
      table.spheres.push_back(sphere);
    }
  }

  // Reads the base order. For transparency it has all triangles. For overdraw it has the triangles of the
  // orders, which must all have the same ones.
  void read_base(OrderSet& set) {
    std::vector<std::uint32_t>& base = set.base_sequence;
    base.resize(mesh_.triangles.size());
    std::iota(base.begin(), base.end(), 0U);
    if (!overdraw_) return;
    if (extension_.has("patchOffsets") && whole_patches_) {
      set.patch_offsets = patch_offsets();
      base.resize(set.patch_offsets.back());
    } else {
      base.clear();
      for (const NodeId node : set.orders.front()) base.push_back(triangle_of(node));
      std::sort(base.begin(), base.end());
    }
    // No order has a triangle twice. An order with as many triangles as the base, all of them in the base,
    // therefore has exactly those of the base.
    std::vector<bool> in_base(mesh_.triangles.size(), false);
    for (const std::uint32_t triangle : base) in_base[triangle] = true;
    for (std::size_t i = 0; i < set.orders.size(); ++i) {
      const NodeSequence& order = set.orders[i];
      const bool same =
          order.size() == base.size() &&
          std::all_of(order.begin(), order.end(), [&](NodeId node) { return in_base[triangle_of(node)]; });
      if (!same) extension_.fail("orders[" + std::to_string(i) + "] does not draw every triangle once");
    }
  }

  // JSON has no infinity; null stands for it.
  static double number_or_infinity(const Fields& fields, const char* key) {
    const Json* value = fields.find(key);
    if (value != nullptr && value->is_null()) return std::numeric_limits<double>::infinity();
    return fields.number_or(key, 0);
  }

  std::optional<OrderErrorRecord> read_error() const {
    const auto error = extension_.find_object("error");
    if (!error) return std::nullopt;
    OrderErrorRecord record;
    constexpr std::uint64_t kMost = std::numeric_limits<std::uint32_t>::max();
    record.viewpoints = static_cast<std::uint32_t>(std::min(error->index_or("views", 0), kMost));
    record.size = static_cast<std::uint32_t>(std::min(error->index_or("size", 0), kMost));
    record.ipr_mean = error->number_or("mean", 0);
    record.ipr_max = error->number_or("max", 0);
    record.psnr_mean = number_or_infinity(*error, "psnr");
    const Json* by_distance = error->find_array("byDistance");
    if (by_distance == nullptr) return record;
    for (const Json& pair : *by_distance) {
      if (!pair.is_array() || pair.size() != 2 || !(pair[0].is_number() || pair[0].is_null()) ||
          !pair[1].is_number()) {
        error->fail("byDistance does not hold pairs of distance and error");
      }
      record.by_distance.push_back(
          {pair[0].is_null() ? kInfiniteDistance : pair[0].get<double>(), pair[1].get<double>()});
    }
    return record;
  }

  const Fields& extension_;
  const Mesh& mesh_;
  AccessorReader& accessors_;
  std::uint64_t animations_;
  bool overdraw_ = false;
  bool reversed_ = false;
  bool whole_patches_ = true;  // no order is stored as indices
  std::vector<std::uint32_t> patch_offsets_;
};

}  // namespace

StoredOrders read_order_extension(const Fields& extension, const Mesh& mesh, AccessorReader& accessors,
                                  std::uint64_t animations) {
  return OrderExtensionReader(extension, mesh, accessors, animations).read();
}

}  // namespace pellucid
