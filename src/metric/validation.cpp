// Implements validation.h: rasterises held-out viewpoints and compares the orders with the exact order.
#include "metric/validation.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "pellucid/raster.h"
#include "pellucid/shading.h"

namespace pellucid {

ValidationOptions held_out_viewpoints(const ValidRange& range, bool front_only, std::uint64_t seed,
                                      const Progress* progress) {
  ValidationOptions options;
  options.min_distance = std::max(range.from, std::min(2.0, range.to));
  options.max_distance = std::clamp(5.0, options.min_distance, std::max(options.min_distance, range.to));
  options.front_only = front_only;
  options.seed = seed + 0x5EED;
  options.progress = progress;
  return options;
}

OrderError measure_order_error(const Mesh& mesh, const BoundingSphere& sphere, const ViewPartition& partition,
                               const std::vector<std::uint32_t>& cluster_of,
                               const std::vector<std::vector<std::uint32_t>>& ranks,
                               const ValidationOptions& options) {
  std::vector<Viewpoint> viewpoints = random_viewpoints(
      options.viewpoints, options.min_distance,
      std::isinf(options.max_distance) ? options.min_distance : options.max_distance, options.seed);
  if (std::isinf(options.min_distance)) {
    for (Viewpoint& viewpoint : viewpoints) viewpoint.distance = kInfiniteDistance;
  }
  const bool with_psnr = options.image_alpha > 0;
  ShadingOptions shading;
  shading.alpha = options.image_alpha;
  Mesh with_normals;
  if (with_psnr && mesh.normals.size() != mesh.positions.size()) {
    with_normals = mesh;
    with_normals.normals = vertex_normals(mesh);
  }
  const Mesh& shaded = with_normals.normals.empty() ? mesh : with_normals;

  std::vector<FrameError> frames(viewpoints.size());
  PerThread<FragmentBuffer> buffers;
  parallel_loop(std::size_t{0}, viewpoints.size(), [&](std::size_t i) {
    stop_if_requested(options.progress);
    FragmentBuffer& fragments = buffers.local();
    RasterOptions raster;
    raster.culling = options.front_only ? Culling::back : Culling::none;
    const Camera camera = look_at_sphere(sphere, viewpoints[i], options.size, options.size);
    rasterize(mesh, camera, raster, fragments);
    const std::vector<std::uint32_t>& drawn =
        ranks[cluster_of[find_cell(partition, viewpoints[i].direction)]];
    if (with_psnr) {
      frames[i] = frame_error(shaded, camera, fragments, drawn, shading);
    } else {
      const PixelCount count = count_incorrect_pixels(fragments, drawn);
      frames[i] = {count.foreground, count.incorrect, count.repaired, 0};
    }
  });
  double ipr = 0;
  double psnr = 0;
  double repaired = 0;
  for (const FrameError& frame : frames) {
    ipr += frame.ipr();
    repaired += static_cast<double>(frame.repaired) /
                static_cast<double>(std::max<std::uint64_t>(frame.foreground, 1));
    psnr += frame.psnr();
  }
  const auto count = static_cast<double>(frames.size());
  return {ipr / count, with_psnr ? psnr / count : -1, repaired / count};
}

}  // namespace pellucid
