// overdraw.cpp - fragments shaded per covered pixel under an early depth test.
#include "pellucid/overdraw.h"

#include "base/parallel.h"
#include "pellucid/metric.h"

namespace pellucid {

OverdrawStatistics measure_overdraw(const Mesh& mesh, std::span<const Viewpoint> viewpoints,
                                    std::uint32_t size,
                                    const std::function<std::span<const NodeId>(const Viewpoint&)>& choose) {
  const BoundingSphere sphere = bounding_sphere(mesh);
  std::vector<OverdrawStatistics> frames(viewpoints.size());
  PerThread<FragmentBuffer> buffers;
  parallel_loop(std::size_t{0}, viewpoints.size(), [&](std::size_t i) {
    FragmentBuffer& buffer = buffers.local();
    rasterize(mesh, look_at_sphere(sphere, viewpoints[i], size, size), {Culling::back}, buffer);
    // Isolated: parallel work in there must not begin another frame on this thread's buffer.
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

}  // namespace pellucid
