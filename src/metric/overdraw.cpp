// overdraw.cpp - fragments shaded per covered pixel under an early depth test.
#include <tbb/enumerable_thread_specific.h>
#include <tbb/task_arena.h>

#include <algorithm>

#include "base/parallel.h"
#include "pellucid/metric.h"

namespace pellucid {
namespace {

// How many of a pixel's fragments (sorted by depth) pass a strict depth test when drawn by rank: those whose
// rank is below that of everything as near or nearer. Fragments without a rank are not drawn.
std::uint64_t count_shaded(std::span<const Fragment> list, std::span<const std::uint32_t> ranks) {
  std::uint64_t shaded = 0;
  std::uint32_t first_rank = kNoRank;  // smallest rank of everything nearer
  for (std::size_t i = 0; i < list.size();) {
    // Of fragments at one depth only the first drawn can pass.
    std::uint32_t rank = kNoRank;
    const float depth = list[i].depth;
    for (; i < list.size() && list[i].depth == depth; ++i) rank = std::min(rank, ranks[list[i].node]);
    if (rank >= first_rank) continue;
    first_rank = rank;
    ++shaded;
  }
  return shaded;
}

}  // namespace

OverdrawStatistics measure_overdraw(const Mesh& mesh, std::span<const Viewpoint> viewpoints,
                                    std::uint32_t size,
                                    const std::function<std::span<const NodeId>(const Viewpoint&)>& choose) {
  const BoundingSphere sphere = bounding_sphere(mesh);
  std::vector<OverdrawStatistics> frames(viewpoints.size());
  tbb::enumerable_thread_specific<FragmentBuffer> buffers;
  parallel_loop(std::size_t{0}, viewpoints.size(), [&](std::size_t i) {
    FragmentBuffer& buffer = buffers.local();
    rasterize(mesh, look_at_sphere(sphere, viewpoints[i], size, size), {Culling::back}, buffer);
    // Isolated: parallel work in there must not begin another frame on this thread's buffer.
    std::vector<std::uint32_t> ranks;
    tbb::this_task_arena::isolate([&] { ranks = ranks_of(choose(viewpoints[i]), mesh.triangles.size()); });
    const std::size_t pixels = std::size_t{size} * size;
    for (std::size_t p = 0; p < pixels; ++p) {
      const std::uint64_t shaded = count_shaded(buffer.pixel(p), ranks);
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
