// The rivals that order anew in every frame, or test planes: centroid sort, BSP walk, presorted lists.
#include <algorithm>

#include "baseline/contender.h"

namespace pellucid {
namespace {

// A sorted order is a new one in each frame: what its cache use and its counts are averaged over.
constexpr std::size_t kSortedSequences = 16;

std::span<const Viewpoint> sampled(std::span<const Viewpoint> viewpoints) {
  return viewpoints.first(std::min(viewpoints.size(), kSortedSequences));
}

// The index buffer of a frame, in memory that is used again.
struct FrameBuffer {
  std::vector<std::uint32_t> sequence;
  std::vector<std::uint32_t> indices;
  CentroidSort::Scratch sort;

  // Three indices a triangle, as stored. Returns the last.
  std::uint64_t write(std::span<const Triangle> triangles) {
    indices.resize(3 * sequence.size());
    std::uint32_t* out = indices.data();
    for (const std::uint32_t t : sequence) out = std::copy(triangles[t].begin(), triangles[t].end(), out);
    return indices.empty() ? 0 : indices.back();
  }
  // The same for nodes, twins turned.
  std::uint64_t write_nodes(const Mesh& mesh) {
    indices.resize(3 * sequence.size());
    std::uint32_t* out = indices.data();
    for (const NodeId node : sequence) {
      const Triangle t = corners_of(mesh, node);
      out = std::copy(t.begin(), t.end(), out);
    }
    return indices.empty() ? 0 : indices.back();
  }
};

}  // namespace

Contender centroid_sort(const Mesh& mesh, std::span<const Viewpoint> viewpoints, std::uint32_t cache_size) {
  const BoundingSphere sphere = bounding_sphere(mesh);
  const Mesh* drawn = &mesh;
  const Stopwatch watch;
  const auto sort = std::make_shared<const CentroidSort>(mesh, sphere);
  const double build_seconds = watch.seconds();
  std::vector<NodeSequence> sequences;
  for (const Viewpoint& view : sampled(viewpoints)) sequences.push_back(centroid_sorted(mesh, sphere, view));

  Contender contender;
  MethodReport& report = contender.report;
  report = cache_report(mesh, sequences, MethodKind::baseline, cache_size);
  report.buffers = 1;  // rewritten in every frame
  report.build_seconds = build_seconds;
  report.memory_bytes = bytes_of_indices(mesh, mesh.triangles.size());
  report.auxiliary_bytes = sort->memory_bytes();
  report.triangles_submitted = static_cast<double>(mesh.triangles.size());
  contender.method = {"centroid_sort", [drawn, sort, sphere](const Viewpoint& view) {
                        CentroidSort::Scratch scratch;
                        std::vector<std::uint32_t> triangles;
                        sort->sort(eye_of(sphere, view), scratch, triangles);
                        return ranks_of_triangles(triangles, drawn->triangles.size());
                      }};
  contender.frame_work = [drawn, sort, sphere, buffer = FrameBuffer{}](const Viewpoint& view) mutable {
    sort->sort(eye_of(sphere, view), buffer.sort, buffer.sequence);
    return buffer.write(drawn->triangles);
  };
  return contender;
}

std::optional<Contender> bsp_walk(const Mesh& mesh, std::span<const Viewpoint> viewpoints,
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
  std::vector<NodeSequence> sequences;
  for (const Viewpoint& view : sampled(viewpoints)) {
    std::vector<std::uint32_t> pieces;
    walk_bsp(*tree, eye_of(sphere, view), pieces);
    sequences.push_back(front_nodes(pieces));
  }

  Contender contender;
  contender.mesh = std::shared_ptr<const Mesh>(tree, &tree->mesh);
  MethodReport& report = contender.report;
  report = cache_report(tree->mesh, sequences, MethodKind::baseline, cache_size);
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
  contender.method = {"bsp", [tree, sphere](const Viewpoint& view) {
                        std::vector<std::uint32_t> walked;
                        walk_bsp(*tree, eye_of(sphere, view), walked);
                        return ranks_of_triangles(walked, tree->mesh.triangles.size());
                      }};
  contender.frame_work = [tree, sphere, buffer = FrameBuffer{}](const Viewpoint& view) mutable {
    walk_bsp(*tree, eye_of(sphere, view), buffer.sequence);
    return buffer.write(tree->mesh.triangles);
  };
  return contender;
}

std::optional<Contender> presorted_lists(const Mesh& mesh, const PresortedOptions& options,
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
  std::vector<NodeSequence> sequences;
  std::uint64_t planes = 0;  // stored: the paper's form has one per entry of a list, tested or not
  for (const PresortedList& list : lists->lists) {
    sequences.push_back(list.nodes);
    for (std::size_t copy = 0; copy < list.nodes.size(); ++copy) {
      planes += std::max(1U, list.test_offsets[copy + 1] - list.test_offsets[copy]);
    }
  }

  Contender contender;
  MethodReport& report = contender.report;
  report = cache_report(mesh, sequences, MethodKind::baseline, options.cache_size);
  report.build_seconds = build_seconds;
  report.auxiliary_bytes = planes * sizeof(Plane) + cell_table_bytes(lists->partition, sequences.size());
  const std::span<const Viewpoint> counted = sampled(viewpoints);
  for (const Viewpoint& view : counted) {
    const PresortedList& list = select_list(*lists, view.direction);
    report.triangles_submitted +=
        static_cast<double>(list.nodes.size()) / static_cast<double>(counted.size());
    report.plane_tests += static_cast<double>(list.tests.size()) / static_cast<double>(counted.size());
  }
  const Mesh* drawn = &mesh;
  contender.method = {"dptl", [drawn, lists](const Viewpoint& view) {
                        NodeSequence nodes;
                        walk_list(*lists, select_list(*lists, view.direction), eye_of(lists->sphere, view),
                                  nodes);
                        return ranks_of(nodes, drawn->triangles.size());
                      }};
  contender.frame_work = [drawn, lists, buffer = FrameBuffer{}](const Viewpoint& view) mutable {
    walk_list(*lists, select_list(*lists, view.direction), eye_of(lists->sphere, view), buffer.sequence);
    return buffer.write_nodes(*drawn);
  };
  return contender;
}

}  // namespace pellucid
