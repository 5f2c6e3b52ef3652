// Implements measured_method.h and the rank functions of pellucid/baseline.h: makes a MeasuredMethod, with
// its costs, of every order set and every baseline.
#include <meshoptimizer.h>

#include <algorithm>
#include <array>
#include <map>
#include <memory>
#include <numeric>
#include <optional>

#include "baseline/measured_method.h"
#include "pellucid/baseline.h"
#include "pellucid/runtime/select.h"

namespace pellucid {

// ----------------------------------------------------------------------------------------------------- names

std::span<const std::string_view> baseline_names() {
  static constexpr std::array<std::string_view, 7> kNames{
      "original", "base", "cache_optimized", "cache_optimized_twins", "centroid_sort", "dptl", "bsp"};
  return kNames;
}

Baselines parse_baselines(const std::string& text) {
  if (text == "all") return {true, true, true, true, true};
  Baselines chosen{false, false, false, false, false};
  if (text == "none") return chosen;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    const std::string name = text.substr(begin, end - begin);
    begin = end + 1;
    bool* flag = name == "base"              ? &chosen.base
                 : name == "cache_optimized" ? &chosen.cache_optimized
                 : name == "centroid_sort"   ? &chosen.centroid_sort
                 : name == "bsp"             ? &chosen.bsp
                 : name == "dptl"            ? &chosen.dptl
                                             : nullptr;
    if (flag == nullptr) {
      throw Error(ErrorKind::bad_argument,
                  "there is no baseline '" + name +
                      "'; choose of base, cache_optimized, centroid_sort, bsp, dptl, "
                      "or give all or none");
    }
    *flag = true;
  }
  return chosen;
}

// ------------------------------------------------------------------------------------------ ranks and orders

namespace {

std::vector<std::uint32_t> stored_order(std::uint64_t triangle_count) {
  std::vector<std::uint32_t> order(triangle_count);
  std::iota(order.begin(), order.end(), 0U);
  return order;
}

NodeSequence front_nodes(std::span<const std::uint32_t> triangles) {
  NodeSequence nodes(triangles.size());
  std::transform(triangles.begin(), triangles.end(), nodes.begin(),
                 [](std::uint32_t triangle) { return node_of(triangle, false); });
  return nodes;
}

}  // namespace

std::vector<std::uint32_t> ranks_of_triangles(std::span<const std::uint32_t> order,
                                              std::uint64_t triangle_count) {
  std::vector<std::uint32_t> ranks(2 * triangle_count, kNoRank);
  std::uint32_t next = 0;
  for (const std::uint32_t triangle : order) {
    ranks[node_of(triangle, false)] = next++;
    ranks[node_of(triangle, true)] = next++;
  }
  return ranks;
}

std::vector<std::uint32_t> ranks_as_stored(std::uint64_t triangle_count) {
  std::vector<std::uint32_t> order = stored_order(triangle_count);
  std::reverse(order.begin(), order.end());
  return ranks_of_triangles(order, triangle_count);
}

std::vector<std::uint32_t> ranks_from(const Mesh& mesh, const OrderSet& orders, const Viewpoint& viewpoint) {
  if (viewpoint.distance < orders.valid_from && !orders.base_sequence.empty()) {
    return ranks_of_triangles(orders.base_sequence, mesh.triangles.size());
  }
  return ranks_of(orders.orders[select_order(orders, viewpoint.direction)], mesh.triangles.size());
}

NodeSequence cache_optimized_nodes(const Mesh& mesh, const NodeSequence& nodes) {
  if (nodes.empty()) return {};
  const std::vector<std::uint32_t> indices = index_buffer(mesh, nodes);
  std::vector<std::uint32_t> optimized(indices.size());
  meshopt_optimizeVertexCache(optimized.data(), indices.data(), indices.size(), mesh.positions.size());

  // meshoptimizer moves triangles without rotating their corners. Find each triangle again by its corners;
  // equal triangles stay in file order.
  std::multimap<Triangle, NodeId> by_corners;
  for (const NodeId node : nodes) by_corners.emplace(corners_of(mesh, node), node);
  NodeSequence order;
  order.reserve(nodes.size());
  for (std::size_t i = 0; i < optimized.size(); i += 3) {
    const auto found = by_corners.find({optimized[i], optimized[i + 1], optimized[i + 2]});
    if (found == by_corners.end())
      throw Error(ErrorKind::internal, "the vertex cache order of meshoptimizer lacks a triangle");
    order.push_back(found->second);
    by_corners.erase(found);
  }
  return order;
}

std::vector<std::uint32_t> cache_optimized_order(const Mesh& mesh) {
  std::vector<std::uint32_t> triangles = stored_order(mesh.triangles.size());
  const NodeSequence nodes = cache_optimized_nodes(mesh, front_nodes(triangles));
  std::transform(nodes.begin(), nodes.end(), triangles.begin(), triangle_of);
  return triangles;
}

// ----------------------------------------------------------------------------------------------------- costs

namespace {

std::uint64_t used_vertices(std::span<const std::uint32_t> indices) {
  std::vector<std::uint32_t> sorted(indices.begin(), indices.end());
  std::sort(sorted.begin(), sorted.end());
  return static_cast<std::uint64_t>(std::unique(sorted.begin(), sorted.end()) - sorted.begin());
}

std::uint64_t bytes_of_indices(const Mesh& mesh, std::uint64_t triangles) {
  return triangles * 3 * bytes_per_index(mesh.positions.size());
}

// Returns what all methods have in common: the sizes and the cache statistics of the orders that they can
// draw.
MethodReport cache_report(const Mesh& mesh, std::span<const NodeSequence> orders, MethodKind kind,
                          std::uint32_t cache_size) {
  MethodReport report;
  report.kind = kind;
  report.buffers = static_cast<std::uint32_t>(orders.size());
  const auto statistics = [&](CacheModel model, std::uint32_t size) {
    std::vector<BufferStatistics> buffers;
    for (const NodeSequence& order : orders) {
      buffers.push_back(sequence_statistics(mesh, order, model, size));
    }
    return pooled(buffers);
  };
  std::uint64_t vertices = 0;
  for (const NodeSequence& order : orders) vertices += used_vertices(index_buffer(mesh, order));
  report.fifo = statistics(CacheModel::fifo, cache_size);
  report.acmr_lru = statistics(CacheModel::lru, cache_size).acmr;
  for (std::size_t i = 0; i < kReportedCaches.size(); ++i) {
    report.acmr_by_cache[i] = statistics(kReportedCaches[i].model, kReportedCaches[i].size).acmr;
  }
  report.atvr = vertices == 0 ? 0 : static_cast<double>(report.fifo.misses) / static_cast<double>(vertices);
  report.memory_bytes = bytes_of_indices(mesh, report.fifo.triangles);
  return report;
}

// Returns the mean length of the order of a view cell. All cells cover about the same part of the sphere.
double mean_length(const OrderSet& orders) {
  double sum = 0;
  for (const std::uint32_t order : orders.cell_orders)
    sum += static_cast<double>(orders.orders[order].size());
  return orders.cell_orders.empty() ? 0 : sum / static_cast<double>(orders.cell_orders.size());
}

// The table that select.h reads. It is stored as in a file, except for the width of its entries.
struct SelectionTable {
  PellucidOrders orders{};
  std::vector<std::uint32_t> entries;  // one per triangle (S) or corner of one (P)
};

std::shared_ptr<const SelectionTable> selection_table(const OrderSet& set) {
  auto table = std::make_shared<SelectionTable>();
  const ViewPartition partition = make_partition(set.partition);
  if (has_triangle_cells(set.partition)) {
    table->entries = set.cell_orders;
  } else {
    for (const std::uint32_t cell : partition.corner_cells) table->entries.push_back(set.cell_orders[cell]);
  }
  PellucidOrders& orders = table->orders;
  orders.cells = has_triangle_cells(set.partition) ? pellucid_cells_triangles : pellucid_cells_corners;
  orders.level = set.partition.level;
  orders.center[0] = set.sphere.center.x;
  orders.center[1] = set.sphere.center.y;
  orders.center[2] = set.sphere.center.z;
  orders.radius = set.sphere.radius;
  orders.min_distance = set.valid_from;
  orders.max_distance = set.valid_to;
  orders.cell_orders = table->entries.data();
  orders.cell_order_bytes = sizeof(std::uint32_t);
  orders.fallback_order = PELLUCID_NO_ORDER;
  return table;
}

}  // namespace

std::uint64_t cell_table_bytes(const PartitionSpec& partition, std::size_t orders) {
  const std::uint64_t triangles = pellucid_triangle_count(partition.level);
  const std::uint64_t entries = has_triangle_cells(partition) ? triangles : 3 * triangles;
  return entries * (orders <= 255 ? 1 : orders <= 65535 ? 2 : 4);
}

std::function<std::uint64_t(const Viewpoint&)> selection_work(const OrderSet& orders) {
  return [table = selection_table(orders), sphere = orders.sphere](const Viewpoint& view) -> std::uint64_t {
    static constexpr double kIdentity[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    const Eye eye = eye_of(sphere, view);
    const double at[3] = {eye.at.x, eye.at.y, eye.at.z};
    if (eye.w != 0) return pellucid_select_perspective(&table->orders, kIdentity, at);
    const double forward[3] = {-at[0], -at[1], -at[2]};
    return pellucid_select_orthographic(&table->orders, kIdentity, forward);
  };
}

// ------------------------------------------------------------------------------ single orders and order sets

MeasuredMethod single_order_method(const Mesh& mesh, const std::string& name,
                                   std::vector<std::uint32_t> triangles, std::uint32_t cache_size) {
  auto ranks = std::make_shared<const std::vector<std::uint32_t>>(
      ranks_of_triangles(triangles, mesh.triangles.size()));
  auto nodes = std::make_shared<const NodeSequence>(front_nodes(triangles));
  MeasuredMethod method;
  method.report = cache_report(mesh, std::span(nodes.get(), 1), MethodKind::baseline, cache_size);
  method.report.triangles_submitted = static_cast<double>(nodes->size());
  method.drawing = {name, [ranks](const Viewpoint&) { return *ranks; }};
  method.order = [nodes](const Viewpoint&) { return std::span<const NodeId>(*nodes); };
  return method;
}

MeasuredMethod stored_order_method(const Mesh& mesh, std::uint32_t cache_size) {
  const std::uint64_t triangles = mesh.triangles.size();
  MeasuredMethod method = single_order_method(mesh, "original", stored_order(triangles), cache_size);
  method.drawing.ranks = [triangles](const Viewpoint&) { return ranks_as_stored(triangles); };
  return method;
}

MeasuredMethod order_set_method(const MeasureSubject& subject, std::uint32_t cache_size) {
  const Mesh* mesh = subject.mesh;
  const OrderSet* orders = subject.orders;
  MeasuredMethod method;
  method.report = cache_report(*mesh, orders->orders, MethodKind::orders, cache_size);
  method.report.auxiliary_bytes = cell_table_bytes(orders->partition, orders->orders.size());
  method.report.triangles_submitted = mean_length(*orders);
  method.frame_work = selection_work(*orders);
  method.drawing = {subject.label,
                    [mesh, orders](const Viewpoint& view) { return ranks_from(*mesh, *orders, view); }};
  method.order = [orders](const Viewpoint& view) {
    return std::span<const NodeId>(orders->orders[select_order(*orders, view.direction)]);
  };
  return method;
}

MeasuredMethod cache_optimized(const Mesh& mesh, std::uint32_t cache_size) {
  const Stopwatch watch;
  std::vector<std::uint32_t> order = cache_optimized_order(mesh);
  const double seconds = watch.seconds();
  MeasuredMethod method = single_order_method(mesh, "cache_optimized", std::move(order), cache_size);
  method.report.build_seconds = seconds;
  return method;
}

// Draws the nodes of every buffer of an order set in the order that suits the vertex cache alone.
MeasuredMethod cache_optimized_twins(const Mesh& mesh, const OrderSet& orders, std::uint32_t cache_size) {
  auto optimized = std::make_shared<OrderSet>(orders);
  for (NodeSequence& order : optimized->orders) order = cache_optimized_nodes(mesh, order);
  MeasuredMethod method;
  method.report = cache_report(mesh, optimized->orders, MethodKind::baseline, cache_size);
  method.report.auxiliary_bytes = cell_table_bytes(optimized->partition, optimized->orders.size());
  method.report.triangles_submitted = mean_length(*optimized);
  method.frame_work = selection_work(*optimized);
  const Mesh* drawn = &mesh;
  method.drawing = {"cache_optimized_twins", [drawn, optimized](const Viewpoint& view) {
                      return ranks_from(*drawn, *optimized, view);
                    }};
  method.order = [optimized](const Viewpoint& view) {
    return std::span<const NodeId>(optimized->orders[select_order(*optimized, view.direction)]);
  };
  return method;
}

// -------------------------------------------------------------------------- methods that work in every frame

namespace {

// A method that sorts has a new order in each frame. Its cache statistics and counts are means over this
// number of orders.
constexpr std::size_t kSortedOrders = 16;

std::span<const Viewpoint> sampled(std::span<const Viewpoint> viewpoints) {
  return viewpoints.first(std::min(viewpoints.size(), kSortedOrders));
}

// The index buffer of a frame. Its memory is reused.
struct FrameBuffer {
  std::vector<std::uint32_t> order;
  std::vector<std::uint32_t> indices;
  CentroidSort::Scratch sort;

  // Writes three indices per triangle, as stored. Returns the last index.
  std::uint64_t write(std::span<const Triangle> triangles) {
    indices.resize(3 * order.size());
    std::uint32_t* out = indices.data();
    for (const std::uint32_t t : order) out = std::copy(triangles[t].begin(), triangles[t].end(), out);
    return indices.empty() ? 0 : indices.back();
  }
  // Does the same for nodes; back-facing copies have reversed corners.
  std::uint64_t write_nodes(const Mesh& mesh) {
    indices.resize(3 * order.size());
    std::uint32_t* out = indices.data();
    for (const NodeId node : order) {
      const Triangle t = corners_of(mesh, node);
      out = std::copy(t.begin(), t.end(), out);
    }
    return indices.empty() ? 0 : indices.back();
  }
};

}  // namespace

MeasuredMethod centroid_sort(const Mesh& mesh, std::span<const Viewpoint> viewpoints,
                             std::uint32_t cache_size) {
  const BoundingSphere sphere = bounding_sphere(mesh);
  const Mesh* drawn = &mesh;
  const Stopwatch watch;
  const auto sort = std::make_shared<const CentroidSort>(mesh, sphere);
  const double build_seconds = watch.seconds();
  std::vector<NodeSequence> orders;
  for (const Viewpoint& view : sampled(viewpoints)) orders.push_back(centroid_sorted(mesh, sphere, view));

  MeasuredMethod method;
  MethodReport& report = method.report;
  report = cache_report(mesh, orders, MethodKind::baseline, cache_size);
  report.buffers = 1;  // rewritten in every frame
  report.build_seconds = build_seconds;
  report.memory_bytes = bytes_of_indices(mesh, mesh.triangles.size());
  report.auxiliary_bytes = sort->memory_bytes();
  report.triangles_submitted = static_cast<double>(mesh.triangles.size());
  method.drawing = {"centroid_sort", [drawn, sort, sphere](const Viewpoint& view) {
                      CentroidSort::Scratch scratch;
                      std::vector<std::uint32_t> triangles;
                      sort->sort(eye_of(sphere, view), scratch, triangles);
                      return ranks_of_triangles(triangles, drawn->triangles.size());
                    }};
  method.frame_work = [drawn, sort, sphere, buffer = FrameBuffer{}](const Viewpoint& view) mutable {
    sort->sort(eye_of(sphere, view), buffer.sort, buffer.order);
    return buffer.write(drawn->triangles);
  };
  return method;
}

std::optional<MeasuredMethod> bsp_walk(const Mesh& mesh, std::span<const Viewpoint> viewpoints,
                                       std::uint32_t cache_size, Progress* progress,
                                       std::vector<std::string>& notes) {
  BspOptions options;
  options.progress = progress;
  const Stopwatch watch;
  const auto tree = std::make_shared<const BspTree>(build_bsp(mesh, options));
  const double build_seconds = watch.seconds();
  if (!tree->complete) {
    notes.push_back("bsp: left out: its planes split " + format_count(mesh.triangles.size()) +
                    " triangles into more than " + format_count(options.max_pieces) + " pieces");
    return std::nullopt;
  }
  const BoundingSphere sphere = bounding_sphere(mesh);
  std::vector<NodeSequence> orders;
  for (const Viewpoint& view : sampled(viewpoints)) {
    std::vector<std::uint32_t> pieces;
    walk_bsp(*tree, eye_of(sphere, view), pieces);
    orders.push_back(front_nodes(pieces));
  }

  MeasuredMethod method;
  method.mesh = std::shared_ptr<const Mesh>(tree, &tree->mesh);
  MethodReport& report = method.report;
  report = cache_report(tree->mesh, orders, MethodKind::baseline, cache_size);
  report.buffers = 1;  // rewritten in every frame
  report.build_seconds = build_seconds;
  const std::uint64_t pieces = tree->mesh.triangles.size();
  const std::uint64_t new_vertices = tree->mesh.positions.size() - mesh.positions.size();
  report.memory_bytes = bytes_of_indices(tree->mesh, pieces);
  report.auxiliary_bytes = tree->nodes.size() * sizeof(BspNode) + bytes_of_indices(tree->mesh, pieces) +
                           new_vertices * sizeof(Vec3f);
  report.triangles_submitted = static_cast<double>(pieces);
  report.plane_tests = static_cast<double>(tree->nodes.size());
  report.splits = tree->splits;
  method.drawing = {"bsp", [tree, sphere](const Viewpoint& view) {
                      std::vector<std::uint32_t> walked;
                      walk_bsp(*tree, eye_of(sphere, view), walked);
                      return ranks_of_triangles(walked, tree->mesh.triangles.size());
                    }};
  method.frame_work = [tree, sphere, buffer = FrameBuffer{}](const Viewpoint& view) mutable {
    walk_bsp(*tree, eye_of(sphere, view), buffer.order);
    return buffer.write(tree->mesh.triangles);
  };
  return method;
}

std::optional<MeasuredMethod> presorted_lists(const Mesh& mesh, const PresortedOptions& options,
                                              std::span<const Viewpoint> viewpoints,
                                              std::vector<std::string>& notes) {
  const Stopwatch watch;
  const auto lists = std::make_shared<const PresortedLists>(build_presorted_lists(mesh, options));
  const double build_seconds = watch.seconds();
  if (!lists->complete) {
    notes.push_back("dptl: left out: a region needs more than " + format_count(options.max_edges) +
                    " occlusions or " + format_count(options.max_copies) + " copies in its list");
    return std::nullopt;
  }
  std::vector<NodeSequence> orders;
  std::uint64_t planes =
      0;  // stored: in the paper every entry of a list has one, whether it is tested or not
  for (const PresortedList& list : lists->lists) {
    orders.push_back(list.nodes);
    for (std::size_t copy = 0; copy < list.nodes.size(); ++copy) {
      planes += std::max(1U, list.test_offsets[copy + 1] - list.test_offsets[copy]);
    }
  }

  MeasuredMethod method;
  MethodReport& report = method.report;
  report = cache_report(mesh, orders, MethodKind::baseline, options.cache_size);
  report.build_seconds = build_seconds;
  report.auxiliary_bytes = planes * sizeof(Plane) + cell_table_bytes(lists->partition, orders.size());
  const std::span<const Viewpoint> counted = sampled(viewpoints);
  for (const Viewpoint& view : counted) {
    const PresortedList& list = select_list(*lists, view.direction);
    report.triangles_submitted +=
        static_cast<double>(list.nodes.size()) / static_cast<double>(counted.size());
    report.plane_tests += static_cast<double>(list.tests.size()) / static_cast<double>(counted.size());
  }
  const Mesh* drawn = &mesh;
  method.drawing = {"dptl", [drawn, lists](const Viewpoint& view) {
                      NodeSequence nodes;
                      walk_list(*lists, select_list(*lists, view.direction), eye_of(lists->sphere, view),
                                nodes);
                      return ranks_of(nodes, drawn->triangles.size());
                    }};
  method.frame_work = [drawn, lists, buffer = FrameBuffer{}](const Viewpoint& view) mutable {
    walk_list(*lists, select_list(*lists, view.direction), eye_of(lists->sphere, view), buffer.order);
    return buffer.write_nodes(*drawn);
  };
  return method;
}

}  // namespace pellucid
