// Overdraw of any orders on held-out pictures, by brute force: see pellucid/overdraw.h.
#include <algorithm>

#include "base/parallel.h"
#include "metric/pose_raster.h"

namespace pellucid {
namespace {

// Drawn by rank of the triangle.
std::uint32_t count_by_triangle(std::span<const Fragment> fragments, std::span<const std::uint32_t> ranks) {
  return count_shaded(fragments, [&](const Fragment& fragment) { return ranks[fragment.node / 2]; });
}

std::vector<OverdrawView> pictures_of(const OverdrawSubject& subject, const OverdrawMeasurement& options) {
  const std::vector<Viewpoint> viewpoints =
      random_viewpoints(options.viewpoints, options.min_distance, options.max_distance, options.seed);
  const std::uint64_t frames = subject.frames.size();
  std::uint64_t each = viewpoints.size();
  if (options.most_pictures > 0)
    each = std::clamp<std::uint64_t>(options.most_pictures / frames, 1, viewpoints.size());
  std::vector<OverdrawView> views;
  for (std::uint32_t frame = 0; frame < frames; ++frame) {
    for (std::uint64_t i = 0; i < each; ++i)
      views.push_back({frame, 0, viewpoints[(frame * each + i) % viewpoints.size()]});
  }
  return views;
}

}  // namespace

std::vector<OverdrawQuality> measure_posed_overdraw(const OverdrawSubject& subject,
                                                    std::span<const OverdrawContender> contenders,
                                                    const OverdrawMeasurement& options) {
  const std::vector<BoundingSphere> spheres = pose_spheres(subject);
  const std::vector<OverdrawView> views = pictures_of(subject, options);
  begin_stage(options.progress, "measure", views.size());
  PerThread<PoseRaster> rasters([&] { return PoseRaster(subject, spheres, options.size); });
  std::vector<double> ratios(views.size() * contenders.size(), 0.0);  // 0: nothing was seen
  parallel_loop(std::size_t{0}, views.size(), [&](std::size_t v) {
    stop_if_requested(options.progress);
    std::vector<std::span<const std::uint32_t>> ranks;
    for (const OverdrawContender& contender : contenders)
      ranks.push_back(contender.ranks(views[v].frame, views[v].viewpoint));
    std::vector<std::uint64_t> shaded(contenders.size(), 0);
    std::uint64_t covered = 0;
    rasters.local().draw(views[v], [&](std::uint64_t /*pixel*/, std::span<const Fragment> fragments) {
      ++covered;
      for (std::size_t c = 0; c < ranks.size(); ++c)
        shaded[c] += fragments.size() == 1 ? 1 : count_by_triangle(fragments, ranks[c]);
    });
    for (std::size_t c = 0; c < ranks.size() && covered > 0; ++c)
      ratios[v * ranks.size() + c] = static_cast<double>(shaded[c]) / static_cast<double>(covered);
    advance_stage(options.progress, 1);
  });

  std::vector<OverdrawQuality> qualities;
  for (std::size_t c = 0; c < contenders.size(); ++c) {
    OverdrawQuality quality;
    quality.name = contenders[c].name;
    quality.by_frame.assign(subject.frames.size(), 0.0);
    std::vector<std::uint64_t> seen(subject.frames.size(), 0);
    std::uint64_t all = 0;
    for (std::size_t v = 0; v < views.size(); ++v) {
      const double ratio = ratios[v * contenders.size() + c];
      if (ratio == 0) continue;
      quality.mean += ratio;
      quality.max = std::max(quality.max, ratio);
      quality.by_frame[views[v].frame] += ratio;
      ++seen[views[v].frame];
      ++all;
    }
    if (all > 0) quality.mean /= static_cast<double>(all);
    for (std::size_t frame = 0; frame < seen.size(); ++frame) {
      if (seen[frame] > 0) quality.by_frame[frame] /= static_cast<double>(seen[frame]);
    }
    qualities.push_back(std::move(quality));
  }
  return qualities;
}

std::vector<std::uint32_t> shaded_fragments(const OverdrawSubject& subject, std::uint32_t frame,
                                            const Viewpoint& viewpoint, std::uint32_t size,
                                            std::span<const std::uint32_t> ranks) {
  const std::vector<BoundingSphere> spheres = pose_spheres(subject);
  std::vector<std::uint32_t> shaded(std::size_t{size} * size, 0);
  PoseRaster(subject, spheres, size)
      .draw({frame, 0, viewpoint}, [&](std::uint64_t pixel, std::span<const Fragment> fragments) {
        shaded[pixel] = count_by_triangle(fragments, ranks);
      });
  return shaded;
}

std::vector<std::uint32_t> triangle_ranks(std::span<const std::uint32_t> sequence) {
  std::vector<std::uint32_t> ranks(sequence.size());
  for (std::uint32_t rank = 0; rank < sequence.size(); ++rank) ranks[sequence[rank]] = rank;
  return ranks;
}

double acmr_of(const OverdrawSubject& subject, const std::vector<std::vector<std::uint32_t>>& sequences,
               std::uint32_t cache_size) {
  double sum = 0;
  const auto vertices = static_cast<std::uint32_t>(subject.frames.front().size());
  for (const std::vector<std::uint32_t>& sequence : sequences) {
    sum += static_cast<double>(cache_misses(subject.triangles, sequence, vertices, cache_size)) /
           static_cast<double>(sequence.size());
  }
  return sum / static_cast<double>(sequences.size());
}

}  // namespace pellucid
