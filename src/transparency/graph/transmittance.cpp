// How much light reaches a face: see transmittance.h.
#include "transparency/graph/transmittance.h"

#include <algorithm>
#include <cmath>

namespace pellucid {
namespace {

// Pixels a side: see docs/in-depth-buffers.md for what other sizes give.
constexpr std::uint32_t kSize = 128;
// Heights closer than this many pixels are those of the same sheet of the surface.
constexpr double kSheet = 1.0;

// The picture of a viewpoint in the coordinates of ScreenTriangles.
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

  // Fragments in front of a face at the pixel of its middle.
  // Of the same sheet as the face are fragments near its plane: neighbours, which the pixel centre may meet.
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

  // Depth of a fragment at a height of ScreenTriangles: see Fragment and screen_triangles.h.
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

}  // namespace pellucid
