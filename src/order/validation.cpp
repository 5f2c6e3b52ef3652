// The error of orders as pixels see it: see validation.h.
#include "validation.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "pellucid/raster.h"

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

double measure_incorrect_pixels(const Mesh& mesh, const BoundingSphere& sphere,
                                const ViewPartition& partition, const std::vector<std::uint32_t>& cluster_of,
                                const std::vector<std::vector<std::uint32_t>>& ranks,
                                const ValidationOptions& options) {
  std::vector<Viewpoint> viewpoints = random_viewpoints(
      options.viewpoints, options.min_distance,
      std::isinf(options.max_distance) ? options.min_distance : options.max_distance, options.seed);
  if (std::isinf(options.min_distance)) {
    for (Viewpoint& viewpoint : viewpoints) viewpoint.distance = kInfiniteDistance;
  }
  std::vector<double> errors(viewpoints.size(), 0.0);
  tbb::enumerable_thread_specific<FragmentBuffer> buffers;
  tbb::parallel_for(std::size_t{0}, viewpoints.size(), [&](std::size_t i) {
    stop_if_requested(options.progress);
    FragmentBuffer& fragments = buffers.local();
    RasterOptions raster;
    raster.culling = options.front_only ? Culling::back : Culling::none;
    rasterize(mesh, look_at_sphere(sphere, viewpoints[i], options.size, options.size), raster, fragments);
    const std::uint32_t cluster = cluster_of[find_cell(partition, viewpoints[i].direction)];
    const PixelCount count = count_incorrect_pixels(fragments, ranks[cluster]);
    if (count.foreground > 0) {
      errors[i] = static_cast<double>(count.incorrect) / static_cast<double>(count.foreground);
    }
  });
  return std::accumulate(errors.begin(), errors.end(), 0.0) / static_cast<double>(errors.size());
}

}  // namespace pellucid
