// Implements measure_order_quality() of pellucid/metric.h: measures IPR and PSNR of methods over many
// viewpoints (In-Depth Buffers, section 7). Every frame is rasterised once for all methods.
#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "pellucid/metric.h"

namespace pellucid {
namespace {

constexpr std::size_t kDistanceBins = 6;

// Returns the mean errors in equal ranges of distance. Ranges without a viewpoint are left out.
std::vector<DistanceError> split_by_distance(std::span<const FrameError> frames,
                                             std::span<const Viewpoint> viewpoints, double low, double high) {
  if (!(low < high) || !std::isfinite(high)) return {};
  struct Sum {
    double ipr = 0, psnr = 0;
    std::uint32_t count = 0;
  };
  std::array<Sum, kDistanceBins> sums{};
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const double place = (viewpoints[i].distance - low) / (high - low) * kDistanceBins;
    Sum& sum = sums[std::min(static_cast<std::size_t>(std::max(place, 0.0)), kDistanceBins - 1)];
    sum.ipr += frames[i].ipr();
    sum.psnr += frames[i].psnr();
    ++sum.count;
  }
  std::vector<DistanceError> bins;
  for (std::size_t k = 0; k < kDistanceBins; ++k) {
    if (sums[k].count == 0) continue;
    const double upper = low + (high - low) * static_cast<double>(k + 1) / kDistanceBins;
    bins.push_back({upper, sums[k].ipr / sums[k].count, sums[k].psnr / sums[k].count});
  }
  return bins;
}

void summarize(MethodQuality& quality, std::span<const Viewpoint> viewpoints, const MeasureOptions& options) {
  if (quality.frames.empty()) return;
  quality.psnr_min = kPerfectPsnr;
  for (const FrameError& frame : quality.frames) {
    quality.ipr_mean += frame.ipr();
    quality.ipr_max = std::max(quality.ipr_max, frame.ipr());
    quality.psnr_mean += frame.psnr();
    quality.psnr_min = std::min(quality.psnr_min, frame.psnr());
  }
  const auto count = static_cast<double>(quality.frames.size());
  quality.ipr_mean /= count;
  quality.psnr_mean /= count;
  quality.by_distance =
      split_by_distance(quality.frames, viewpoints, options.min_distance, options.max_distance);
}

}  // namespace

std::vector<MethodQuality> measure_order_quality(const Mesh& mesh, std::span<const DrawingMethod> methods,
                                                 const MeasureOptions& options) {
  const std::vector<Viewpoint> viewpoints =
      random_viewpoints(options.viewpoints, options.min_distance, options.max_distance, options.seed);
  const BoundingSphere sphere = bounding_sphere(mesh);
  const RasterOptions raster{options.facing == Facing::single ? Culling::back : Culling::none};
  Mesh shaded = mesh;
  if (shaded.normals.size() != shaded.positions.size()) shaded.normals = vertex_normals(mesh);

  std::vector<MethodQuality> qualities(methods.size());
  for (std::size_t m = 0; m < methods.size(); ++m) {
    qualities[m].name = methods[m].name;
    qualities[m].frames.resize(viewpoints.size());
  }

  begin_stage(options.progress, "measure", viewpoints.size());
  PerThread<FragmentBuffer> buffers;
  parallel_loop(std::size_t{0}, viewpoints.size(), [&](std::size_t i) {
    stop_if_requested(options.progress);
    FragmentBuffer& buffer = buffers.local();
    const Camera camera = look_at_sphere(sphere, viewpoints[i], options.size, options.size);
    rasterize(shaded, camera, raster, buffer);
    for (std::size_t m = 0; m < methods.size(); ++m) {
      std::vector<std::uint32_t> ranks;
      // Isolate the call, because parallel work inside `ranks` must not begin another frame, which would
      // overwrite the buffer of this thread.
      run_isolated([&] { ranks = methods[m].ranks(viewpoints[i]); });
      qualities[m].frames[i] = frame_error(shaded, camera, buffer, ranks, options.shading);
    }
    advance_stage(options.progress, 1);
  });

  for (MethodQuality& quality : qualities) summarize(quality, viewpoints, options);
  return qualities;
}

}  // namespace pellucid
