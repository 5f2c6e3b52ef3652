// Implements the overdraw functions of pellucid/metric.h, and pose_raster.h: rasterises every frame and
// counts the fragments that pass the depth test. It does not use patches, so it is an independent check of
// the counts of the module `overdraw`.
#include <algorithm>

#include "base/parallel.h"
#include "metric/pose_raster.h"
#include "pellucid/metric.h"

namespace pellucid {

// --------------------------------------------------------------------------------------------- static meshes

OverdrawStatistics measure_overdraw(const Mesh& mesh, std::span<const Viewpoint> viewpoints,
                                    std::uint32_t size,
                                    const std::function<std::span<const NodeId>(const Viewpoint&)>& choose) {
  const BoundingSphere sphere = bounding_sphere(mesh);
  std::vector<OverdrawStatistics> frames(viewpoints.size());
  PerThread<FragmentBuffer> buffers;
  parallel_loop(std::size_t{0}, viewpoints.size(), [&](std::size_t i) {
    FragmentBuffer& buffer = buffers.local();
    rasterize(mesh, look_at_sphere(sphere, viewpoints[i], size, size), {Culling::back}, buffer);
    // Isolate the call, because parallel work inside `choose` must not begin another frame, which would
    // overwrite the buffer of this thread.
    std::vector<std::uint32_t> ranks;
    run_isolated([&] { ranks = ranks_of(choose(viewpoints[i]), mesh.triangles.size()); });
    const std::size_t pixels = std::size_t{size} * size;
    for (std::size_t p = 0; p < pixels; ++p) {
      const std::uint64_t shaded =
          count_shaded(buffer.pixel(p), [&](const Fragment& fragment) { return ranks[fragment.node]; });
      frames[i].covered += shaded > 0 ? 1U : 0U;
      frames[i].shaded += shaded;
    }
  });

  OverdrawStatistics total;
  for (const OverdrawStatistics& frame : frames) {
    total.covered += frame.covered;
    total.shaded += frame.shaded;
  }
  if (total.covered > 0)
    total.overdraw = static_cast<double>(total.shaded) / static_cast<double>(total.covered);
  return total;
}

// ----------------------------------------------------------------------------------- the fragments of a pose

std::vector<BoundingSphere> pose_spheres(const OverdrawSubject& subject) {
  Mesh mesh;
  mesh.triangles = subject.triangles;
  std::vector<BoundingSphere> spheres;
  for (const std::vector<Vec3f>& positions : subject.frames) {
    mesh.positions = positions;
    spheres.push_back(bounding_sphere(mesh));
  }
  return spheres;
}

PoseRaster::PoseRaster(const OverdrawSubject& subject, std::span<const BoundingSphere> spheres,
                       std::uint32_t size)
    : subject_(subject), spheres_(spheres), size_(size) {
  mesh_.triangles = subject.triangles;
}

void PoseRaster::draw(const OverdrawView& view,
                      const std::function<void(std::uint64_t, std::span<const Fragment>)>& visit) {
  if (frame_ != view.frame) {
    mesh_.positions = subject_.frames[view.frame];
    frame_ = view.frame;
  }
  const std::vector<std::uint8_t>& double_sided = subject_.double_sided;
  const bool all_culled = double_sided.empty();
  rasterize(mesh_, look_at_sphere(spheres_[view.frame], view.viewpoint, size_, size_),
            {all_culled ? Culling::back : Culling::none}, buffer_);
  const std::uint64_t pixels = std::uint64_t{size_} * size_;
  for (std::uint64_t p = 0; p < pixels; ++p) {
    std::span<const Fragment> fragments = buffer_.pixel(p);
    if (!all_culled) {
      visible_.clear();
      for (const Fragment& fragment : fragments) {
        if ((fragment.node & 1U) == 0 || double_sided[fragment.node / 2] != 0) visible_.push_back(fragment);
      }
      fragments = visible_;
    }
    if (!fragments.empty()) visit(p, fragments);
  }
}

// ------------------------------------------------------------------------------------------- animated meshes

namespace {

// Counts the fragments that pass the depth test when triangles are drawn by rank.
std::uint32_t count_by_triangle(std::span<const Fragment> fragments, std::span<const std::uint32_t> ranks) {
  return count_shaded(fragments, [&](const Fragment& fragment) { return ranks[fragment.node / 2]; });
}

std::vector<OverdrawView> views_to_measure(const OverdrawSubject& subject,
                                           const PosedOverdrawOptions& options) {
  const std::vector<Viewpoint> viewpoints =
      random_viewpoints(options.viewpoints, options.min_distance, options.max_distance, options.seed);
  const std::uint64_t frames = subject.frames.size();
  std::uint64_t each = viewpoints.size();
  if (options.most_images > 0)
    each = std::clamp<std::uint64_t>(options.most_images / frames, 1, viewpoints.size());
  std::vector<OverdrawView> views;
  for (std::uint32_t frame = 0; frame < frames; ++frame) {
    for (std::uint64_t i = 0; i < each; ++i)
      views.push_back({frame, 0, viewpoints[(frame * each + i) % viewpoints.size()]});
  }
  return views;
}

}  // namespace

std::vector<OverdrawQuality> measure_posed_overdraw(const OverdrawSubject& subject,
                                                    std::span<const PosedDrawingMethod> methods,
                                                    const PosedOverdrawOptions& options) {
  const std::vector<BoundingSphere> spheres = pose_spheres(subject);
  const std::vector<OverdrawView> views = views_to_measure(subject, options);
  begin_stage(options.progress, "measure", views.size());
  PerThread<PoseRaster> rasters([&] { return PoseRaster(subject, spheres, options.size); });
  std::vector<double> ratios(views.size() * methods.size(), 0.0);  // 0: nothing was seen
  parallel_loop(std::size_t{0}, views.size(), [&](std::size_t v) {
    stop_if_requested(options.progress);
    std::vector<std::span<const std::uint32_t>> ranks;
    for (const PosedDrawingMethod& method : methods)
      ranks.push_back(method.ranks(views[v].frame, views[v].viewpoint));
    std::vector<std::uint64_t> shaded(methods.size(), 0);
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
  for (std::size_t c = 0; c < methods.size(); ++c) {
    OverdrawQuality quality;
    quality.name = methods[c].name;
    quality.by_frame.assign(subject.frames.size(), 0.0);
    std::vector<std::uint64_t> seen(subject.frames.size(), 0);
    std::uint64_t all = 0;
    for (std::size_t v = 0; v < views.size(); ++v) {
      const double ratio = ratios[v * methods.size() + c];
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
