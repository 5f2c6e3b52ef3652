// All occlusions between faces from one viewpoint: see viewpoint_edges.h.
#include "transparency/graph/viewpoint_edges.h"

#include <algorithm>
#include <cmath>

#include "pellucid/raster.h"
#include "pellucid/shading.h"
#include "transparency/graph/transmittance.h"

namespace pellucid {
namespace {

// Group scratch edges by front triangle (counting sort, stable).
void group_by_front(const std::vector<PairEdge>& edges, const std::vector<NodeId>& nodes,
                    std::size_t triangle_count, ViewpointEdges& out) {
  out.offsets.assign(triangle_count + 1, 0);
  for (const PairEdge& e : edges) ++out.offsets[triangle_of(nodes[e.front]) + 1];
  for (std::size_t t = 0; t < triangle_count; ++t) out.offsets[t + 1] += out.offsets[t];
  out.backs.resize(edges.size());
  out.areas.resize(edges.size());
  std::vector<std::uint32_t> cursor(out.offsets.begin(), out.offsets.end() - 1);
  for (const PairEdge& e : edges) {
    const std::uint32_t slot = cursor[triangle_of(nodes[e.front])]++;
    out.backs[slot] = nodes[e.back];
    out.areas[slot] = e.area;
  }
}

}  // namespace

void find_edges_exactly(const OcclusionScene& scene, const Viewpoint& viewpoint, OcclusionScratch& scratch,
                        ViewpointEdges& out) {
  ScreenTriangles& screen = scratch.screen;
  project_triangles(scene.positions, scene.mesh.triangles, viewpoint, scene.front_only, screen);
  scratch.search.find(screen.bounds, scratch.pairs);
  scratch.edges.clear();
  scratch.doubtful.clear();
  test_pairs(screen, scratch.pairs, static_cast<float>(scene.tolerance), scratch.edges, scratch.doubtful);
  out.intersecting = 0;
  for (const CandidatePair& pair : scratch.doubtful) {
    if (test_pair_precisely(screen, scene.mesh.triangles, pair, scratch.edges)) ++out.intersecting;
  }
  if (scene.alpha > 0) {
    find_light(scene, viewpoint, screen, scratch.fragments, scratch.light);
    for (PairEdge& edge : scratch.edges) edge.area *= scratch.light[triangle_of(screen.nodes[edge.front])];
  }
  out.front_flipped = screen.flipped;
  group_by_front(scratch.edges, screen.nodes, scene.mesh.triangles.size(), out);
}

void find_edges_by_raster(const OcclusionScene& scene, const Viewpoint& viewpoint, OcclusionScratch& scratch,
                          ViewpointEdges& out) {
  const Camera camera = look_at_sphere(scene.sphere, viewpoint, scene.raster_size, scene.raster_size);
  RasterOptions options;
  options.culling = scene.front_only ? Culling::back : Culling::none;
  rasterize(scene.mesh, camera, options, scratch.fragments);

  // One key per pair of fragments in consecutive depths; equal keys are the pixels of one edge.
  std::vector<std::uint64_t>& keys = scratch.keys;
  keys.clear();
  out.front_flipped.assign(scene.mesh.triangles.size(), 0);
  const std::uint64_t pixels = std::uint64_t{camera.width} * camera.height;
  for (std::uint64_t p = 0; p < pixels; ++p) {
    const std::span<const Fragment> fragments = scratch.fragments.pixel(p);
    for (std::size_t i = 0; i < fragments.size(); ++i) {
      if (is_flipped(fragments[i].node)) out.front_flipped[triangle_of(fragments[i].node)] = 1;
      // Ties hide nothing from each other, but all of them hide the next one and what is tied with it.
      std::size_t next = i + 1;
      while (next < fragments.size() && fragments[next].depth - fragments[i].depth <= kDepthTie) ++next;
      for (std::size_t j = next;
           j < fragments.size() && fragments[j].depth - fragments[next].depth <= kDepthTie; ++j) {
        keys.push_back(std::uint64_t{fragments[i].node} << 32U | fragments[j].node);
      }
    }
  }
  std::sort(keys.begin(), keys.end());

  // Picture of the sphere: radius 1 at orthographic scale; a perspective one is scaled to the same units.
  const double half_extent = camera.perspective ? camera.half_height * viewpoint.distance : 1.0;
  const double pixel_area = 4.0 * half_extent * half_extent / static_cast<double>(pixels);
  if (scene.alpha > 0) {
    scratch.light.resize(scene.mesh.triangles.size());
    find_light_of_triangles(scratch.fragments, scene.alpha, scratch.light);
  }
  std::vector<std::uint32_t> counts(scene.mesh.triangles.size() + 1, 0);
  out.backs.clear();
  out.areas.clear();
  for (std::size_t i = 0; i < keys.size();) {
    std::size_t end = i;
    while (end < keys.size() && keys[end] == keys[i]) ++end;
    const std::uint32_t front = triangle_of(static_cast<NodeId>(keys[i] >> 32U));
    ++counts[front + 1];
    out.backs.push_back(static_cast<NodeId>(keys[i]));
    const double area = static_cast<double>(end - i) * pixel_area;
    out.areas.push_back(static_cast<float>(scene.alpha > 0 ? area * double{scratch.light[front]} : area));
    i = end;
  }
  for (std::size_t t = 0; t + 1 < counts.size(); ++t) counts[t + 1] += counts[t];
  out.offsets = std::move(counts);
  out.intersecting = 0;
}

}  // namespace pellucid
