// Implements viewpoint_edges.h: finds the occlusions of one viewpoint by geometry or by a raster, and weights
// them by light transmittance.
#include "transparency/graph/viewpoint_edges.h"

#include <algorithm>
#include <cmath>

#include "pellucid/raster.h"
#include "pellucid/shading.h"

namespace pellucid {

// ----------------------------------------------------------------------------------------- light
// transmittance

namespace {

// Pixels per side. docs/in-depth-buffers.md has the results of other sizes.
constexpr std::uint32_t kSize = 128;
// Heights that are closer than this many pixels belong to the same sheet of the surface.
constexpr double kSheet = 1.0;

// A small image of a viewpoint, in the coordinates of ScreenTriangles.
class LightMap {
 public:
  LightMap(const OcclusionScene& scene, const Viewpoint& viewpoint, FragmentBuffer& fragments)
      : camera_(look_at_sphere(scene.sphere, viewpoint, kSize, kSize)),
        distance_(viewpoint.distance),
        radius_(scene.sphere.radius),
        fragments_(fragments) {
    const ViewAxes axes = view_axes(viewpoint.direction);
    camera_.right = axes.right;
    camera_.up = axes.up;
    RasterOptions options;
    options.culling = scene.front_only ? Culling::back : Culling::none;
    rasterize(scene.mesh, camera_, options, fragments_);
    pixel_ = 2 * (camera_.perspective ? camera_.half_height * distance_ : 1.0) / kSize;
  }

  // Returns the number of fragments in front of a face at the pixel of its middle. Fragments near its plane
  // belong to the same sheet, as the pixel centre may lie in a neighbour of the face, and do not count.
  [[nodiscard]] std::size_t layers_before(const ScreenTriangle& face) const {
    const std::uint32_t column = cell_of((face.x[0] + face.x[1] + face.x[2]) / 3);
    const std::uint32_t row = kSize - 1 - cell_of((face.y[0] + face.y[1] + face.y[2]) / 3);
    const double x = (column + 0.5) * pixel_ - 0.5 * kSize * pixel_;
    const double y = 0.5 * kSize * pixel_ - (row + 0.5) * pixel_;
    const double height = face.height + (x - face.x[0]) * face.slope_x + (y - face.y[0]) * face.slope_y;
    const double nearest =
        depth_at(std::clamp<double>(height, face.min_height, face.max_height) + kSheet * pixel_);
    const std::span<const Fragment> list = fragments_.pixel(std::size_t{row} * kSize + column);
    const auto behind =
        std::find_if(list.begin(), list.end(), [&](const Fragment& f) { return f.depth >= nearest; });
    return static_cast<std::size_t>(behind - list.begin());
  }

 private:
  [[nodiscard]] std::uint32_t cell_of(float coordinate) const {
    const double cell = std::floor(coordinate / pixel_ + 0.5 * kSize);
    return static_cast<std::uint32_t>(std::clamp(cell, 0.0, kSize - 1.0));
  }

  // Returns the depth of a fragment at a height of ScreenTriangles (see Fragment and screen_pairs.h).
  [[nodiscard]] double depth_at(double height) const {
    if (!camera_.perspective)
      return (radius_ * (1 - height) + (camera_.far_plane - 2 * radius_) / 2) / camera_.far_plane;
    const double inverse = (height + distance_) / (distance_ * distance_ * radius_);
    const double nearest = 1 / camera_.near_plane;
    return (nearest - inverse) / (nearest - 1 / camera_.far_plane);
  }

  Camera camera_;
  double distance_, radius_;
  double pixel_ = 0;  // bounding radii
  FragmentBuffer& fragments_;
};

}  // namespace

void find_light_of_triangles(const FragmentBuffer& fragments, double alpha, std::vector<float>& light) {
  std::vector<std::uint32_t> counts(light.size(), 0);
  std::vector<double> sums(light.size(), 0.0);
  const std::uint64_t pixels = std::uint64_t{fragments.width} * fragments.height;
  for (std::uint64_t p = 0; p < pixels; ++p) {
    double reaching = 1;
    for (const Fragment& fragment : fragments.pixel(p)) {
      sums[triangle_of(fragment.node)] += reaching;
      ++counts[triangle_of(fragment.node)];
      reaching *= 1 - alpha;
    }
  }
  for (std::size_t t = 0; t < light.size(); ++t)
    light[t] = counts[t] == 0 ? kNoLightKnown : static_cast<float>(sums[t] / counts[t]);
}

void find_light(const OcclusionScene& scene, const Viewpoint& viewpoint, const ScreenTriangles& screen,
                FragmentBuffer& fragments, std::vector<float>& light) {
  const LightMap map(scene, viewpoint, fragments);
  light.resize(scene.mesh.triangles.size());
  find_light_of_triangles(fragments, scene.alpha, light);
  for (std::size_t i = 0; i < screen.triangles.size(); ++i) {
    float& own = light[triangle_of(screen.nodes[i])];
    if (own != kNoLightKnown) continue;
    const auto layers = static_cast<double>(map.layers_before(screen.triangles[i]));
    own = static_cast<float>(std::pow(1 - scene.alpha, layers));
  }
}

// ----------------------------------------------------------------------------------------------------- edges

namespace {

// Groups edges by front triangle (counting sort, stable).
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
      // Tied fragments do not hide each other. All of them hide the next fragment and those that are tied
      // with it.
      std::size_t next = i + 1;
      while (next < fragments.size() && fragments[next].depth - fragments[i].depth <= kDepthTie) ++next;
      for (std::size_t j = next;
           j < fragments.size() && fragments[j].depth - fragments[next].depth <= kDepthTie; ++j) {
        keys.push_back(std::uint64_t{fragments[i].node} << 32U | fragments[j].node);
      }
    }
  }
  std::sort(keys.begin(), keys.end());

  // In an orthographic image the sphere has radius 1. A perspective image is scaled to the same units.
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
