// Implements upsample.h: carries orders from a simplified mesh to the full one, repairs them by sifting nodes
// that are in a wrong order, and arranges them for the vertex cache.
#include "transparency/upsample.h"

#if PELLUCID_EMBREE_VERSION == 4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <tuple>
#include <unordered_map>

#include "base/parallel.h"
#include "sequencing/cache_order.h"
#include "sequencing/linear_order.h"
#include "transparency/graph/viewpoint_edges.h"

namespace pellucid {

namespace {

struct CloseDevice {
  void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
};
struct CloseScene {
  void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
};
using Device = std::unique_ptr<RTCDeviceTy, CloseDevice>;
using Scene = std::unique_ptr<RTCSceneTy, CloseScene>;

// Returns the squared distance from p to triangle abc (Ericson, "Real-Time Collision Detection", 2004,
// section 5.1.5, by regions).
double squared_distance(const Vec3d& p, const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  const Vec3d ab = b - a;
  const Vec3d ac = c - a;
  const Vec3d normal = cross(ab, ac);
  const double area2 = dot(normal, normal);
  const auto to_segment = [&](const Vec3d& q, const Vec3d& r) {
    const Vec3d qr = r - q;
    const double l = dot(qr, qr);
    const double t = l > 0 ? std::clamp(dot(p - q, qr) / l, 0.0, 1.0) : 0.0;
    const Vec3d d = p - (q + qr * t);
    return dot(d, d);
  };
  if (area2 > 0) {
    const double u = dot(cross(c - b, p - b), normal);
    const double v = dot(cross(a - c, p - c), normal);
    const double w = dot(cross(ab, p - a), normal);
    if (u >= 0 && v >= 0 && w >= 0) {
      const double height = dot(p - a, normal);
      return height * height / area2;
    }
  }
  return std::min({to_segment(a, b), to_segment(b, c), to_segment(c, a)});
}

struct Query {
  const Mesh& coarse;
  const std::vector<Vec3d>& coarse_normals;
  Vec3d point;
  Vec3d normal;
  double best = std::numeric_limits<double>::infinity();  // distance, with the penalty
  std::uint32_t triangle = std::numeric_limits<std::uint32_t>::max();
};

constexpr double kOtherSidePenalty = 4.0;

bool visit_triangle(RTCPointQueryFunctionArguments* args) {
  Query& query = *static_cast<Query*>(args->userPtr);
  const Triangle& t = query.coarse.triangles[args->primID];
  const double squared =
      squared_distance(query.point, to_double(query.coarse.positions[t[0]]),
                       to_double(query.coarse.positions[t[1]]), to_double(query.coarse.positions[t[2]]));
  const bool same_side = dot(query.normal, query.coarse_normals[args->primID]) > 0;
  const double distance = std::sqrt(squared) * (same_side ? 1.0 : kOtherSidePenalty);
  const bool nearer = distance < query.best || (distance == query.best && args->primID < query.triangle);
  if (!nearer) return false;
  query.best = distance;
  query.triangle = args->primID;
  // A little wider than the best, so that all equal distances are seen in any order of visits.
  const auto radius = static_cast<float>(distance * (1.0 + 1e-5));
  if (radius >= args->query->radius) return false;
  args->query->radius = radius;
  return true;
}

std::vector<Vec3d> normals_of(const Mesh& mesh) {
  std::vector<Vec3d> normals(mesh.triangles.size());
  for (std::uint32_t t = 0; t < normals.size(); ++t) normals[t] = triangle_normal(mesh, t);
  return normals;
}

Scene build_scene(RTCDevice device, const Mesh& mesh) {
  Scene scene(rtcNewScene(device));
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  void* vertices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                           sizeof(Vec3f), mesh.positions.size());
  void* indices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                          sizeof(Triangle), mesh.triangles.size());
  std::copy(mesh.positions.begin(), mesh.positions.end(), static_cast<Vec3f*>(vertices));
  std::copy(mesh.triangles.begin(), mesh.triangles.end(), static_cast<Triangle*>(indices));
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene.get(), geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(scene.get());
  return scene;
}

}  // namespace

std::vector<NodeId> nearest_coarse_nodes(const Mesh& fine, const Mesh& coarse) {
  const Device device(rtcNewDevice(nullptr));
  if (device == nullptr) throw Error(ErrorKind::internal, "Embree cannot start on this machine");
  const Scene scene = build_scene(device.get(), coarse);
  const std::vector<Vec3d> coarse_normals = normals_of(coarse);
  std::vector<NodeId> nodes(2 * fine.triangles.size());
  parallel_loop(std::uint32_t{0}, static_cast<std::uint32_t>(fine.triangles.size()), [&](std::uint32_t t) {
    const Triangle& corners = fine.triangles[t];
    const Vec3d centroid = (to_double(fine.positions[corners[0]]) + to_double(fine.positions[corners[1]]) +
                            to_double(fine.positions[corners[2]])) /
                           3.0;
    const Vec3f p = to_float(centroid);
    Query query{coarse, coarse_normals, centroid, triangle_normal(fine, t)};
    RTCPointQuery point_query{p.x, p.y, p.z, 0.0F, std::numeric_limits<float>::infinity()};
    RTCPointQueryContext context;
    rtcInitPointQueryContext(&context);
    rtcPointQuery(scene.get(), &point_query, &context, visit_triangle, &query);
    const std::uint32_t nearest = query.triangle < coarse.triangles.size() ? query.triangle : 0;
    const bool turned = dot(query.normal, coarse_normals[nearest]) < 0;
    nodes[2 * t] = node_of(nearest, turned);
    nodes[2 * t + 1] = node_of(nearest, !turned);
  });
  return nodes;
}

std::vector<double> upsampled_keys(std::span<const NodeId> coarse_nodes,
                                   std::span<const std::uint32_t> coarse_ranks,
                                   std::span<const double> depth_keys) {
  std::vector<double> keys(coarse_nodes.size());
  for (std::size_t node = 0; node < keys.size(); ++node) {
    // Depth keys lie in -1 .. 1: less than one rank.
    keys[node] = coarse_ranks[coarse_nodes[node]] + 0.45 * std::clamp(depth_keys[node], -1.0, 1.0);
  }
  return keys;
}

// ---------------------------------------------------------------------------------------------------- repair

namespace {

// Between the nodes that a moved node passes there are nodes without a known preference about it. It is
// placed this many ranks behind the last node that it passes.
constexpr double kStep = 0.25;

constexpr std::uint32_t kViewsPerBatch = 16;
// The edges of a cluster are merged when this many have been collected.
constexpr std::size_t kMostPending = std::size_t{1} << 24U;

struct SeenEdge {
  NodeId front, back;
  std::uint32_t view;  // makes the order of a sum the same for any number of threads
  float weight;
};

// The edges of one cluster: merged edges, sorted, and then the edges that were added since.
class EdgeCollection {
 public:
  void append(const std::vector<SeenEdge>& edges) {
    edges_.insert(edges_.end(), edges.begin(), edges.end());
    if (edges_.size() - merged_ > std::max(kMostPending, merged_)) merge();
  }

  EdgeRows rows(std::uint32_t node_count) {
    merge();
    EdgeRows rows;
    rows.offsets.assign(node_count + 1, 0);
    rows.backs.reserve(edges_.size());
    rows.weights.reserve(edges_.size());
    for (const SeenEdge& edge : edges_) {
      ++rows.offsets[edge.front + 1];
      rows.backs.push_back(edge.back);
      rows.weights.push_back(edge.weight);
    }
    for (std::uint32_t node = 0; node < node_count; ++node) rows.offsets[node + 1] += rows.offsets[node];
    return rows;
  }

 private:
  void merge() {
    // All keys differ, because a view shows an edge once, and the merged sums hold it once.
    const auto key = [](const SeenEdge& e) { return std::tuple(e.front, e.back, e.view); };
    parallel_sort(edges_.begin(), edges_.end(),
                  [&](const SeenEdge& a, const SeenEdge& b) { return key(a) < key(b); });
    std::size_t kept = 0;
    for (std::size_t i = 0; i < edges_.size();) {
      SeenEdge sum = edges_[i];
      for (++i; i < edges_.size() && edges_[i].front == sum.front && edges_[i].back == sum.back; ++i)
        sum.weight += edges_[i].weight;
      sum.view = 0;  // merged sums come before what is seen later
      edges_[kept++] = sum;
    }
    edges_.resize(kept);
    merged_ = kept;
  }

  std::vector<SeenEdge> edges_;
  std::size_t merged_ = 0;
};

class Refiner {
 public:
  Refiner(const Mesh& mesh, const BoundingSphere& sphere, const ViewPartition& partition,
          const std::vector<std::uint32_t>& cluster_of, const RefineOptions& options,
          std::vector<std::vector<std::uint32_t>>& ranks)
      : scene_{mesh, sphere, {}, options.front_only, 0, options.raster_size, options.alpha},
        partition_(partition),
        options_(options),
        ranks_(ranks),
        node_count_(static_cast<std::uint32_t>(2 * mesh.triangles.size())),
        clusters_of_sample_(partition.samples.size()) {
    for (std::uint32_t cell = 0; cell < partition.cell_count(); ++cell) {
      for (const std::uint32_t sample : partition.samples_of(cell)) {
        std::vector<std::uint32_t>& clusters = clusters_of_sample_[sample];
        if (std::find(clusters.begin(), clusters.end(), cluster_of[cell]) == clusters.end())
          clusters.push_back(cluster_of[cell]);
      }
    }
    // Discrete viewpoints have one sample each: all distances there; else samples take turns.
    distances_per_sample_ = partition.spec.kind == PartitionKind::viewpoints ? options.distances.size() : 1;
  }

  // Returns the edges that agree with the final ranks and span less than a window of them.
  std::vector<EdgeRows> run() {
    begin_stage(options_.progress, "refinement", (2 * options_.rounds + 1) * view_count());
    for (std::uint32_t round = 0; round < options_.rounds; ++round) {
      const std::string name = std::string("round-").append(std::to_string(round));
      if (auto known = recorded<std::vector<std::vector<std::uint32_t>>>(options_.records, name)) {
        ranks_ = std::move(*known);
        advance_stage(options_.progress, 2 * view_count());
        continue;
      }
      const std::vector<EdgeRows> wrong = collect([&](std::uint32_t cluster, NodeId front, NodeId back) {
        return ranks_[cluster][back] < ranks_[cluster][front];
      });
      std::vector<std::vector<std::uint8_t>> movable;
      movable.reserve(wrong.size());
      for (const EdgeRows& edges : wrong) movable.push_back(nodes_of(edges));
      const std::vector<EdgeRows> known = collect([&](std::uint32_t cluster, NodeId front, NodeId back) {
        return movable[cluster][front] != 0 || movable[cluster][back] != 0;
      });
      parallel_loop(std::size_t{0}, ranks_.size(), [&](std::size_t cluster) {
        stop_if_requested(options_.progress);
        SiftOptions options;
        options.movable = movable[cluster];
        options.progress = options_.progress;
        options.step = kStep;
        sift(net_preferences(known[cluster]), options, ranks_[cluster]);
      });
      record(options_.records, name, ranks_);
    }
    return checkpointed_clusters([&] { return binding_edges(); });
  }

 private:
  // Returns the edges that agree with the ranks and span less than a window of them.
  std::vector<EdgeRows> binding_edges() {
    const std::uint32_t window = refine_window(node_count_);
    return collect([&](std::uint32_t cluster, NodeId front, NodeId back) {
      const std::uint32_t rank = ranks_[cluster][front];
      return rank < ranks_[cluster][back] && ranks_[cluster][back] < rank + window;
    });
  }

  // There is one record per cluster, because all of them together may be as large as everything else.
  template <class Make>
  std::vector<EdgeRows> checkpointed_clusters(const Make& make) {
    const auto name_of = [](std::size_t cluster) {
      return std::string("edges-").append(std::to_string(cluster));
    };
    std::vector<EdgeRows> known;
    while (known.size() < ranks_.size()) {
      std::optional<EdgeRows> edges = recorded<EdgeRows>(options_.records, name_of(known.size()));
      if (!edges) break;
      known.push_back(std::move(*edges));
    }
    if (known.size() == ranks_.size()) return known;
    known = make();
    for (std::size_t cluster = 0; cluster < known.size(); ++cluster)
      record(options_.records, name_of(cluster), known[cluster]);
    return known;
  }

  [[nodiscard]] std::size_t view_count() const { return partition_.samples.size() * distances_per_sample_; }

  static std::vector<std::uint8_t> nodes_of(const EdgeRows& edges) {
    std::vector<std::uint8_t> nodes(edges.node_count(), 0);
    for (NodeId front = 0; front < edges.node_count(); ++front) {
      if (edges.offsets[front] < edges.offsets[front + 1]) nodes[front] = 1;
    }
    for (const NodeId back : edges.backs) nodes[back] = 1;
    return nodes;
  }

  // Returns for every cluster the edges that are seen from its samples and for which wanted(cluster, front,
  // back) holds.
  template <class Predicate>
  std::vector<EdgeRows> collect(const Predicate& wanted) {
    std::vector<EdgeCollection> collections(ranks_.size());
    for (std::size_t begin = 0; begin < view_count(); begin += kViewsPerBatch) {
      const std::size_t end = std::min(begin + kViewsPerBatch, view_count());
      std::vector<std::vector<std::vector<SeenEdge>>> seen(end - begin);  // view, cluster
      parallel_loop(begin, end, [&](std::size_t view) {
        stop_if_requested(options_.progress);
        seen[view - begin] = look(view, wanted);
        advance_stage(options_.progress, 1);
      });
      for (const auto& by_cluster : seen) {
        for (std::size_t cluster = 0; cluster < collections.size(); ++cluster)
          collections[cluster].append(by_cluster[cluster]);
      }
    }
    std::vector<EdgeRows> rows;
    rows.reserve(collections.size());
    for (EdgeCollection& collection : collections) {
      rows.push_back(collection.rows(node_count_));
      collection = {};
    }
    return rows;
  }

  template <class Predicate>
  std::vector<std::vector<SeenEdge>> look(std::size_t view, const Predicate& wanted) {
    const std::size_t sample = view / distances_per_sample_;
    const Viewpoint viewpoint{partition_.samples[sample],
                              options_.distances[view % options_.distances.size()]};
    ViewpointEdges& edges = edges_.local();
    find_edges_by_raster(scene_, viewpoint, scratch_.local(), edges);
    std::vector<std::vector<SeenEdge>> seen(ranks_.size());
    for (const std::uint32_t cluster : clusters_of_sample_[sample]) {
      for (std::uint32_t t = 0; t + 1 < edges.offsets.size(); ++t) {
        const NodeId front = node_of(t, edges.front_flipped[t] != 0);
        for (std::uint32_t i = edges.offsets[t]; i < edges.offsets[t + 1]; ++i) {
          const NodeId back = edges.backs[i];
          if (!wanted(cluster, front, back)) continue;
          // View 0 stands for merged sums.
          seen[cluster].push_back({front, back, static_cast<std::uint32_t>(view) + 1, edges.areas[i]});
        }
      }
    }
    return seen;
  }

  OcclusionScene scene_;
  const ViewPartition& partition_;
  const RefineOptions& options_;
  std::vector<std::vector<std::uint32_t>>& ranks_;
  std::uint32_t node_count_;
  std::vector<std::vector<std::uint32_t>> clusters_of_sample_;
  std::size_t distances_per_sample_ = 1;
  PerThread<OcclusionScratch> scratch_;
  PerThread<ViewpointEdges> edges_;
};

// Numbers things in the order of their first use.
class Numbering {
 public:
  std::uint32_t of(std::uint32_t thing) {
    const auto [known, is_new] = numbers_.try_emplace(thing, static_cast<std::uint32_t>(things_.size()));
    if (is_new) things_.push_back(thing);
    return known->second;
  }
  [[nodiscard]] std::uint32_t find(std::uint32_t thing) const {
    const auto known = numbers_.find(thing);
    return known == numbers_.end() ? kNone : known->second;
  }
  [[nodiscard]] const std::vector<std::uint32_t>& things() const { return things_; }
  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

 private:
  std::unordered_map<std::uint32_t, std::uint32_t> numbers_;
  std::vector<std::uint32_t> things_;
};

// Rearranges consecutive nodes for the vertex cache, as a mesh of their own, so that the cost depends only on
// the size of the run.
NodeSequence sequence_of_run(const Mesh& mesh, const EdgeRows& edges, std::span<const NodeId> run,
                             std::span<const std::uint32_t> ranks, const CacheOrderOptions& options) {
  Numbering triangles;
  Numbering vertices;
  Mesh local;
  for (const NodeId node : run) {
    if (triangles.of(triangle_of(node)) < local.triangles.size()) continue;
    Triangle corners{};
    for (std::size_t c = 0; c < 3; ++c) corners[c] = vertices.of(mesh.triangles[triangle_of(node)][c]);
    local.triangles.push_back(corners);
  }
  local.positions.resize(vertices.things().size());

  const std::size_t nodes = 2 * local.triangles.size();
  std::vector<std::uint32_t> local_ranks(nodes, 0);
  std::vector<std::uint8_t> drawn(nodes, 0);
  for (const NodeId node : run) {
    const NodeId own = node_of(triangles.find(triangle_of(node)), is_flipped(node));
    local_ranks[own] = ranks[node];
    drawn[own] = 1;
  }
  EdgeRows rows;
  rows.offsets.push_back(0);
  for (NodeId own = 0; own < nodes; ++own) {
    const NodeId node = node_of(triangles.things()[triangle_of(own)], is_flipped(own));
    for (std::uint32_t i = edges.offsets[node]; drawn[own] != 0 && i < edges.offsets[node + 1]; ++i) {
      const std::uint32_t back = triangles.find(triangle_of(edges.backs[i]));
      if (back == Numbering::kNone) continue;
      rows.backs.push_back(node_of(back, is_flipped(edges.backs[i])));
      rows.weights.push_back(edges.weights[i]);
    }
    rows.offsets.push_back(static_cast<std::uint32_t>(rows.backs.size()));
  }

  NodeSequence sequence = cache_aware_order(local, rows, local_ranks, drawn, options);
  for (NodeId& node : sequence) node = node_of(triangles.things()[triangle_of(node)], is_flipped(node));
  return sequence;
}

}  // namespace

std::uint32_t refine_window(std::uint64_t node_count) {
  return static_cast<std::uint32_t>(std::clamp<std::uint64_t>(node_count / 128, 1024, 65536));
}

std::vector<EdgeRows> refine_orders(const Mesh& mesh, const BoundingSphere& sphere,
                                    const PartitionSpec& partition,
                                    const std::vector<std::uint32_t>& cluster_of,
                                    const RefineOptions& options,
                                    std::vector<std::vector<std::uint32_t>>& ranks) {
  PartitionSpec views = partition;
  if (is_continuous(views)) views.kind = PartitionKind::sampled_triangles;
  views.sample_level = std::min(views.sample_level, 1U);
  const ViewPartition cells = make_partition(views);
  return Refiner(mesh, sphere, cells, cluster_of, options, ranks).run();
}

NodeSequence windowed_sequence(const Mesh& mesh, const EdgeRows& edges, std::span<const std::uint32_t> ranks,
                               std::span<const std::uint8_t> drawn, const CacheOrderOptions& options) {
  const NodeSequence by_rank = order_by_rank(ranks, drawn);
  const std::size_t window = refine_window(ranks.size());
  const std::size_t runs = (by_rank.size() + window - 1) / window;
  NodeSequence sequence(by_rank.size());
  parallel_loop(std::size_t{0}, runs, [&](std::size_t run) {
    const std::size_t begin = run * window;
    const std::size_t end = std::min(begin + window, by_rank.size());
    const NodeSequence sorted =
        sequence_of_run(mesh, edges, std::span(by_rank).subspan(begin, end - begin), ranks, options);
    std::copy(sorted.begin(), sorted.end(), sequence.begin() + static_cast<std::ptrdiff_t>(begin));
  });
  return sequence;
}

}  // namespace pellucid
